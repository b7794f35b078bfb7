#include "sansmesh/mesh/repair/sewn_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/any_threads.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::octasphere;

/// Separate vertices for each triangle.
TriangleMesh soup_of(const TriangleMesh& mesh) {
  TriangleMesh soup;
  for (const Triangle& t : mesh.triangles) {
    const auto base = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(mesh.vertices[v]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  return soup;
}

TEST(SewnMesh, SoupsHangTogether) {
  const TriangleMesh sphere = octasphere(3);
  const SewnMesh sewn = sewn_mesh(soup_of(sphere));
  const MeshTopology topology = sewn_topology(sewn);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.vertices, sphere.vertices.size());
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.genus(), 0);
  EXPECT_EQ(sewn.joined, 3 * sphere.triangles.size() - sphere.vertices.size());
  EXPECT_EQ(topology.unused_vertices, 0u);
  EXPECT_EQ(sewn.left_out, 0u);
}

TEST(SewnMesh, AMeshThatHangsTogetherStaysAsItIs) {
  for (TriangleMesh mesh : {octasphere(2), test::torus_mesh(12, 7)}) {
    EXPECT_EQ(sewn_mesh(mesh).mesh.triangles, mesh.triangles);
    mesh.triangles.resize(mesh.triangles.size() / 2);
    EXPECT_EQ(sewn_mesh(mesh).mesh.triangles, mesh.triangles);
    EXPECT_EQ(sewn_mesh(mesh).joined, 0u);
  }
}

TEST(SewnMesh, WhatOnlyTouchesStaysApart) {
  // Two closed spheres that touch at a point, with separate vertices; and two open fans of triangles.
  const TriangleMesh spheres = test::joined(octasphere(1), octasphere(1), {2, 0, 0});
  EXPECT_EQ(sewn_topology(spheres).components, 2u);
  EXPECT_TRUE(sewn_topology(spheres).closed());
  TriangleMesh fans;
  fans.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {-1, 0, 0}, {-1, -1, 0}};
  fans.triangles = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_EQ(sewn_topology(fans).components, 2u);
  EXPECT_TRUE(sewn_topology(fans).manifold());
}

TEST(SewnMesh, ThreeBordersAtOneEdgeAreNotManifold) {
  TriangleMesh book;
  for (const Vec3f& corner : {Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{-1, 0, 0}}) {
    const auto base = static_cast<std::uint32_t>(book.vertices.size());
    for (const Vec3f& p : {Vec3f{0, 0, 0}, Vec3f{0, 0, 1}, corner}) book.vertices.push_back(p);
    book.triangles.push_back({base, base + 1, base + 2});
  }
  const MeshTopology topology = sewn_topology(book);
  EXPECT_EQ(topology.nonmanifold_edges, 1u);
  EXPECT_EQ(topology.boundary_edges, 6u);
  EXPECT_EQ(topology.open_edges, 7u);
  EXPECT_EQ(topology.components, 1u);
}

TEST(SewnMesh, WhatIsNoTriangleIsLeftOut) {
  TriangleMesh mesh = octasphere(1);
  const auto n = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back({NAN, 0, 0});
  mesh.triangles.push_back({0, 1, n});
  mesh.triangles.push_back({0, 1, n + 5});
  mesh.triangles.push_back({3, 3, 4});
  const MeshTopology topology = sewn_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.degenerate_triangles, 3u);
  EXPECT_EQ(topology.unused_vertices, 1u);
  EXPECT_EQ(sewn_topology(TriangleMesh{}).triangles, 0u);
}

TEST(SewnMesh, ClosedAndManifoldAreTwoThings) {
  // Two octahedra with a common edge: four triangles at one edge, each direction twice.
  TriangleMesh wedge = test::joined(octasphere(0), octasphere(0), {5, 0, 0});
  const Triangle t = wedge.triangles[0], s = wedge.triangles[8];
  for (Triangle& u : wedge.triangles)
    for (std::uint32_t& v : u)
      if (v == s[0])
        v = t[1];
      else if (v == s[1])
        v = t[0];
  const MeshTopology topology = measure_topology(wedge);
  EXPECT_EQ(topology.nonmanifold_edges, 1u);
  EXPECT_EQ(topology.open_edges, 0u);
  EXPECT_TRUE(topology.encloses());
  EXPECT_FALSE(topology.closed());
}

TEST(SewnMesh, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh soup = soup_of(octasphere(5));
  test::compare_threads(
      [&] { return sewn_mesh(soup); },
      [](const SewnMesh& one, const SewnMesh& many) { EXPECT_EQ(one.mesh.triangles, many.mesh.triangles); });
}

}  // namespace
}  // namespace sansmesh::inline v1
