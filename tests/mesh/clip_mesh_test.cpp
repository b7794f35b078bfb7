#include "sansmesh/mesh/edit/clip_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh_measures.h"

namespace sansmesh::inline v1 {
namespace {

/// [-1, 1]² in the plane as n × n squares of two triangles.
TriangleMesh sheet(std::uint32_t n) {
  TriangleMesh mesh;
  const float h = 2.0f / static_cast<float>(n);
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i)
      mesh.vertices.push_back({-1 + h * static_cast<float>(i), -1 + h * static_cast<float>(j), 0});
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

TEST(ClipMesh, KeepsTheDiscWhereAFunctionIsPositive) {
  for (const float snap : {0.0f, 0.3f}) {
    TriangleMesh mesh = sheet(60);
    std::vector<float> heights;
    for (const Vec3f& v : mesh.vertices) heights.push_back(0.7f - norm(v));
    clip_mesh(mesh, heights, snap);
    EXPECT_NEAR(measure_size(mesh).area, 0.49 * std::numbers::pi, 0.49 * std::numbers::pi * 0.002) << snap;
    const MeshTopology topology = measure_topology(mesh);
    EXPECT_EQ(topology.components, 1u);
    EXPECT_TRUE(topology.manifold());
    // The border is the circle.
    double farthest = 0;
    for (const Vec3f& v : mesh.vertices) farthest = std::max(farthest, static_cast<double>(norm(v)));
    EXPECT_NEAR(farthest, 0.7, 0.002) << snap;
  }
}

TEST(ClipMesh, LeavesNoSliversWhereVerticesAreSnapped) {
  TriangleMesh plain = sheet(50), snapped = plain;
  std::vector<float> heights;
  for (const Vec3f& v : plain.vertices) heights.push_back(0.613f - norm(v - Vec3f{0.011f, 0.007f, 0}));
  clip_mesh(plain, heights, 0);
  clip_mesh(snapped, heights, 0.3f);
  EXPECT_LT(measure_quality(plain).smallest_angle, 3);
  EXPECT_GT(measure_quality(snapped).smallest_angle, 10);
}

TEST(ClipMesh, CuttingOutABoxIsWhatClippingLeavesOut) {
  const Box3f box{{-0.53f, -0.21f, -1}, {0.17f, 0.77f, 1}};
  TriangleMesh whole = sheet(6);
  std::vector<std::int32_t> id(whole.triangles.size());
  for (std::size_t i = 0; i < id.size(); ++i) id[i] = static_cast<std::int32_t>(i);
  whole.triangle_attributes.set("id", id);
  TriangleMesh in = whole, out = whole;
  clip_mesh(in, box);
  cut_out_box(out, box);
  EXPECT_NEAR(measure_size(in).area, 0.7 * 0.98, 1e-6);
  EXPECT_NEAR(measure_size(in).area + measure_size(out).area, 4, 1e-6);
  for (const Triangle& t : out.triangles) {
    const Vec3f m = (out.vertices[t[0]] + out.vertices[t[1]] + out.vertices[t[2]]) * (1.0f / 3);
    EXPECT_FALSE(m.x > box.lower.x && m.x < box.upper.x && m.y > box.lower.y && m.y < box.upper.y);
  }
  // One sheet with one hole, without cracks along the cuts; triangles far from the box are unchanged.
  const MeshTopology topology = measure_topology(out);
  EXPECT_TRUE(topology.manifold());
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.boundary_loops, 2u);
  EXPECT_EQ(out.triangle_attributes.find("id")->rows(), out.triangles.size());
  EXPECT_LT(out.triangles.size(), 3 * whole.triangles.size());
  TriangleMesh apart = whole;
  cut_out_box(apart, {{2, 2, 2}, {3, 3, 3}});
  EXPECT_EQ(apart.triangles, whole.triangles);
}

TEST(ClipMesh, OfNothingAboveLeavesNothing) {
  TriangleMesh mesh = sheet(4);
  clip_mesh(mesh, std::vector<float>(mesh.vertices.size(), -1.0f), 0.3f);
  EXPECT_TRUE(mesh.triangles.empty());
  TriangleMesh all = sheet(4);
  clip_mesh(all, std::vector<float>(all.vertices.size(), 1.0f), 0.3f);
  EXPECT_EQ(all.triangles.size(), 32u);
}

}  // namespace
}  // namespace sansmesh::inline v1
