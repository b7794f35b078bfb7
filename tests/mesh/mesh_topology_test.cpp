#include "sansmesh/mesh_measures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/any_threads.h"
#include "support/mesh_checks.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

TEST(MeshTopology, SphereAndTorusHaveTheirGenus) {
  const MeshTopology sphere = measure_topology(test::octasphere(3));
  EXPECT_TRUE(sphere.closed());
  EXPECT_EQ(sphere.euler, 2);
  EXPECT_EQ(sphere.genus(), 0);
  EXPECT_EQ(sphere.edges, 3 * sphere.triangles / 2);
  const MeshTopology torus = measure_topology(test::torus_mesh(20, 9));
  EXPECT_TRUE(torus.closed());
  EXPECT_EQ(torus.genus(), 1);
  const MeshTopology both = measure_topology(test::joined(test::torus_mesh(20, 9), test::octasphere(1), {5, 0, 0}));
  EXPECT_EQ(both.components, 2u);
  EXPECT_EQ(both.largest_component, 360u);
  EXPECT_EQ(both.genus(), 1);
}

TEST(MeshTopology, HolesAreLoopsAndDoNotChangeTheGenus) {
  TriangleMesh mesh = test::octasphere(3);
  mesh.triangles.erase(mesh.triangles.begin() + 100);
  mesh.triangles.erase(mesh.triangles.begin() + 3);
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_FALSE(topology.closed());
  EXPECT_TRUE(topology.manifold());
  EXPECT_EQ(topology.boundary_edges, 6u);
  EXPECT_EQ(topology.boundary_loops, 2u);
  EXPECT_EQ(topology.genus(), 0);
}

TEST(MeshTopology, FindsFlippedTriangles) {
  TriangleMesh mesh = test::octasphere(2);
  std::swap(mesh.triangles[7][0], mesh.triangles[7][1]);
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_EQ(topology.inconsistent_edges, 3u);
  EXPECT_FALSE(topology.closed());
  EXPECT_EQ(topology.genus(), std::nullopt);
}

TEST(MeshTopology, FindsFinsAndTouchingVertices) {
  TriangleMesh fin = test::octasphere(0);
  fin.vertices.push_back({3, 3, 3});
  fin.triangles.push_back({0, 2, 6});
  EXPECT_EQ(measure_topology(fin).nonmanifold_edges, 1u);
  EXPECT_EQ(measure_topology(fin).boundary_edges, 2u);

  TriangleMesh touching = test::joined(test::octasphere(0), test::octasphere(0), {2, 0, 0});
  for (Triangle& t : touching.triangles) std::replace(t.begin(), t.end(), 7u, 0u);  // (-1,0,0) + shift = (1,0,0)
  const MeshTopology topology = measure_topology(touching);
  EXPECT_EQ(topology.nonmanifold_vertices, 1u);
  EXPECT_EQ(topology.nonmanifold_edges, 0u);
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.unused_vertices, 1u);
  EXPECT_FALSE(topology.closed());
}

TEST(MeshTopology, DegenerateTrianglesAreCountedAndDoNotDisturb) {
  TriangleMesh mesh = test::octasphere(1);
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({0, 1, 4000});
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_EQ(topology.degenerate_triangles, 2u);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(measure_topology({}).triangles, 0u);
  EXPECT_FALSE(measure_topology({}).closed());
}

TEST(MeshTopology, AgreesWithTheObviousCountOnRandomTriangles) {
  std::mt19937 generator(3);
  for (int round = 0; round < 50; ++round) {
    TriangleMesh mesh;
    for (int i = 0; i < 12; ++i)
      mesh.vertices.push_back({static_cast<float>(i), static_cast<float>(i * i), static_cast<float>(i % 5)});
    for (int i = 0; i < 15; ++i) {
      const Triangle t{static_cast<std::uint32_t>(generator() % 12), static_cast<std::uint32_t>(generator() % 12),
                       static_cast<std::uint32_t>(generator() % 12)};
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<int>> edges;
    for (const Triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        edges[{std::min(a, b), std::max(a, b)}].push_back(a < b ? 1 : -1);
      }
    std::size_t boundary = 0, fins = 0, inconsistent = 0;
    for (const auto& [edge, uses] : edges) {
      boundary += uses.size() == 1;
      fins += uses.size() > 2;
      inconsistent += uses.size() == 2 && uses[0] == uses[1];
    }
    const MeshTopology topology = measure_topology(mesh);
    EXPECT_EQ(topology.edges, edges.size());
    EXPECT_EQ(topology.boundary_edges, boundary);
    EXPECT_EQ(topology.nonmanifold_edges, fins);
    EXPECT_EQ(topology.inconsistent_edges, inconsistent);
    EXPECT_EQ(topology.closed(), !mesh.triangles.empty() && test::topology_of(mesh).closed_manifold());
  }
}

TEST(MeshTopology, DoesNotDependOnTheNumberOfThreads) {
  TriangleMesh mesh = test::octasphere(6);
  mesh.triangles.resize(mesh.triangles.size() / 2);
  test::compare_threads([&] { return measure_topology(mesh); },
                        [](const MeshTopology& one, const MeshTopology& many) {
                          EXPECT_EQ(one.boundary_edges, many.boundary_edges);
                          EXPECT_EQ(one.euler, many.euler);
                          EXPECT_GT(one.boundary_edges, 0u);
                        });
}

}  // namespace
}  // namespace sansmesh::inline v1
