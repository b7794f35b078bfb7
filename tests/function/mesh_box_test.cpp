// Meshes cut to boxes, and meshes of functions in boxes or with coarser triangles.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>

#include "function/edit_shapes.h"
#include "function/mesh_sets.h"
#include "sansmesh/error.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/mesh/edit/clip_mesh.h"
#include "sansmesh/mesh_options.h"
#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

TriangleMesh cube_mesh() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

void expect_clipped(const TriangleMesh& mesh, const Box3f& box) {
  for (const Vec3f& v : mesh.vertices) EXPECT_TRUE(box.contains(v));
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.manifold());
  EXPECT_TRUE(topology.oriented());
  EXPECT_EQ(topology.unused_vertices, 0u);
  // Borders are in the faces, edge by edge.
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.insert({t[k], t[(k + 1) % 3]});
  std::size_t border = 0;
  for (const auto& [a, b] : edges) {
    if (edges.count({b, a})) continue;
    ++border;
    bool same_face = false;
    for (std::size_t k = 0; k < 3; ++k)
      for (const float f : {box.lower[k], box.upper[k]})
        same_face |= mesh.vertices[a][k] == f && mesh.vertices[b][k] == f;
    EXPECT_TRUE(same_face);
  }
  EXPECT_EQ(border, topology.boundary_edges);
}

TEST(ClipMesh, CubesToTheirArea) {
  struct Case {
    Box3f box;
    double area;
    std::size_t loops;
  };
  const Case cases[] = {
      {{{-2, -2, -2}, {2, 2, 2}}, 24, 0},
      {{{-2, -2, -2}, {0.25f, 2, 2}}, 4 + 4 * 2 * 1.25, 1},
      {{{-0.5f, -2, -2}, {0.25f, 2, 2}}, 4 * 2 * 0.75, 2},
      {{{-0.5f, -0.5f, -2}, {0.25f, 0.75f, 2}}, 2 * 0.75 * 1.25, 2},
      {{{0, 0, 0}, {3, 3, 3}}, 3, 1},
      {{{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}}, 0, 0},
      {{{5, 5, 5}, {6, 6, 6}}, 0, 0},
      {{{-1, -1, -1}, {1, 1, 1}}, 24, 0},
  };
  for (const Case& c : cases) {
    TriangleMesh mesh = cube_mesh();
    clip_mesh(mesh, c.box);
    EXPECT_NEAR(area_of(mesh), c.area, 1e-5);
    EXPECT_EQ(measure_topology(mesh).boundary_loops, c.loops);
    EXPECT_EQ(mesh.triangles.empty(), c.area == 0);
    expect_clipped(mesh, c.box);
  }
}

TEST(ClipMesh, LeavesWhatIsInside) {
  const TriangleMesh sphere = octasphere(4);
  TriangleMesh mesh = sphere;
  clip_mesh(mesh, {{-1, -1, -1}, {1, 1, 1}});
  EXPECT_EQ(mesh.triangles, sphere.triangles);
  EXPECT_EQ(mesh.vertices, sphere.vertices);
  const Box3f box{{-0.3f, -2, 0.1f}, {0.7f, 0.55f, 0.95f}};
  clip_mesh(mesh, box);
  expect_clipped(mesh, box);
  const std::set<Corners> now = triangle_set(mesh);
  std::size_t in = 0;
  for (const Triangle& t : sphere.triangles) {
    if (!std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return box.contains(sphere.vertices[v]); })) continue;
    ++in;
    EXPECT_TRUE(now.count(corners(sphere, t)));
  }
  EXPECT_GT(in, 200u);
}

TEST(ClipMesh, ZonesOfASphere) {
  // Archimedes: the area between parallel planes is 2π times their distance.
  for (const float z : {-0.5f, 0.0f, 0.3f, 0.9f}) {
    TriangleMesh mesh = octasphere(6);
    clip_mesh(mesh, {{-2, -2, z}, {2, 2, 2}});
    EXPECT_NEAR(area_of(mesh), 2 * std::numbers::pi * (1 - static_cast<double>(z)), 3e-3);
    EXPECT_EQ(measure_topology(mesh).boundary_loops, 1u);
  }
}

TEST(ClipMesh, AttributesAreInterpolated) {
  TriangleMesh mesh = octasphere(3);
  mesh.normals = mesh.vertices;
  std::vector<float> linear;
  for (const Vec3f& v : mesh.vertices) {
    linear.push_back(3 * v.x - v.z);
    mesh.colors.push_back({static_cast<std::uint8_t>(128 + 100 * v.x), 7, static_cast<std::uint8_t>(128 + 100 * v.z)});
  }
  mesh.attributes.set("linear", std::move(linear));
  clip_mesh(mesh, {{-0.4f, -0.2f, -2}, {0.35f, 2, 0.6f}});
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  const std::vector<float>& clipped = *mesh.attributes.find<float>("linear");
  ASSERT_EQ(clipped.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    EXPECT_NEAR(clipped[v], 3 * mesh.vertices[v].x - mesh.vertices[v].z, 1e-5);
    EXPECT_NEAR(mesh.colors[v][0], 128 + 100 * mesh.vertices[v].x, 3);
    EXPECT_EQ(mesh.colors[v][1], 7);
    EXPECT_NEAR(norm(mesh.normals[v]), 1, 1e-5);
    EXPECT_GT(dot(mesh.normals[v], normalized(mesh.vertices[v])), 0.999f);
  }
}

TEST(MeshFunction, InABoxIsAPartOfTheWhole) {
  for (const PointSet& cloud : {bumpy(8000), cube(8000)}) {
    const FittedFunction function = fitted(cloud);
    MeshOptions options;
    options.enhance = function.field.report().creased == 0;  // no large triangles on the faces of the cube
    const TriangleMesh whole = meshed(function, options);
    options.box = Box3{{-0.3, 0.1, 0.2}, {0.55, 0.8, 3}};
    const TriangleMesh part = meshed(function, options);
    ASSERT_FALSE(part.triangles.empty());
    const double edge = mean_edge(whole);
    TriangleMesh clipped = whole;
    clip_mesh(clipped, {Vec3f(options.box->lower - clipped.origin), Vec3f(options.box->upper - clipped.origin)});
    EXPECT_NEAR(area_of(part), area_of(clipped), 2e-3 * area_of(clipped));
    for (const Vec3f& v : part.vertices) EXPECT_TRUE(widened(*options.box, 1e-5).contains(part.origin + Vec3(v)));
    const MeshTopology topology = measure_topology(part);
    EXPECT_TRUE(topology.manifold() && topology.oriented());
    EXPECT_EQ(topology.components, 1u);
    EXPECT_EQ(topology.boundary_loops, 1u);
    // The triangles well inside are the same.
    const std::set<Corners> of_whole = triangle_set(whole);
    const Box3 inner = widened(*options.box, -3 * edge);
    std::size_t in = 0, same = 0;
    for (const Triangle& t : part.triangles) {
      bool inside = true;
      for (const std::uint32_t v : t) inside &= inner.contains(part.origin + Vec3(part.vertices[v]));
      in += inside, same += inside && of_whole.count(corners(part, t));
    }
    EXPECT_GT(in, 20u);
    EXPECT_GT(static_cast<double>(same), 0.9 * static_cast<double>(in));
  }
}

TEST(MeshFunction, BoxesOfAnySizeAndPlace) {
  const FittedFunction function = fitted(sphere(3000));
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int round = 0; round < 40; ++round) {
    // Boxes centred on the surface, down to a small share of a triangle.
    const Vec3 at = normalized(Vec3{uniform(random), uniform(random), uniform(random)});
    const double half = std::pow(10.0, -2.5 + 0.05 * round);
    MeshOptions options;
    options.box = widened(Box3{at, at}, half);
    const TriangleMesh mesh = meshed(function, options);
    const double area = area_of(mesh);
    EXPECT_GT(area, 1.5 * half * half) << half;
    EXPECT_LT(area, 15 * half * half) << half;
  }
  for (const Box3& nowhere : {Box3{{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}}, Box3{{5, 5, 5}, {6, 6, 6}},
                              Box3{{1.02, 0, 0}, {1.03, 0.01, 0.01}}}) {
    MeshOptions options;
    options.box = nowhere;
    try {
      meshed(function, options);
      ADD_FAILURE();
    } catch (const DataError& error) {
      EXPECT_NE(std::string(error.what()).find("box"), std::string::npos) << error.what();
    }
  }
}

TEST(MeshFunction, DepthMakesItCoarser) {
  for (const PointSet& cloud : {bumpy(12000), cube(12000)}) {
    const FittedFunction function = fitted(cloud);
    const auto size = static_cast<double>(meshed(function).triangles.size());
    double last = 1e30;
    for (const int depth : {12, 6, 5, 4, 3, 2}) {
      MeshOptions options;
      options.block_depth = depth;
      const TriangleMesh mesh = meshed(function, options);
      expect_closed(mesh);
      const auto n = static_cast<double>(mesh.triangles.size());
      if (depth == 12) {
        EXPECT_EQ(n, size);
      }
      EXPECT_LE(n, 1.05 * last) << depth;
      last = n;
      Box3f box, samples;
      for (const Vec3f& v : mesh.vertices) box.extend(v);
      for (const Vec3f& p : cloud.positions) samples.extend(p);
      EXPECT_LT(norm(box.lower - samples.lower), 0.35f) << depth;
      EXPECT_LT(norm(box.upper - samples.upper), 0.35f) << depth;
    }
    EXPECT_LT(last, 0.3 * size);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
