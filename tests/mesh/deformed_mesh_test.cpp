#include "sansmesh/mesh/edit/deformed_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "sansmesh/error.h"
#include "support/mesh_checks.h"
#include "support/space_maps.h"

namespace sansmesh::inline v1 {
namespace {

using namespace test;

/// Tall bar of 12 triangles with a vertex array and a triangle array.
TriangleMesh bar() {
  TriangleMesh mesh;
  for (int c = 0; c < 8; ++c)
    mesh.vertices.push_back({c & 1 ? 0.5f : -0.5f, c & 2 ? 0.5f : -0.5f, c & 4 ? 2.0f : -2.0f});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  std::vector<float> heights;
  for (const Vec3f& p : mesh.vertices) heights.push_back(p.z);
  mesh.attributes.set("height", std::move(heights));
  mesh.triangle_attributes.set("face", std::vector<std::int32_t>{0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5});
  return mesh;
}

Vec3 normal_of(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
  return normalized(cross(b - a, c - a));
}

TEST(DeformedMesh, LongEdgesAreCutWhereTheMapBendsThem) {
  const TwistMap twist(0.5);
  MeshDeformReport report;
  EXPECT_EQ(deform_mesh(bar(), twist, {}, &report).triangles.size(), 12u);
  for (const double bend : {0.1, 0.01}) {
    const TriangleMesh mesh = deform_mesh(bar(), twist, {bend}, &report);
    EXPECT_TRUE(report.fine);
    EXPECT_EQ(report.added + 12, mesh.triangles.size());
    EXPECT_TRUE(topology_of(mesh).closed_manifold());
    // A twist does not change heights; arrays follow their vertices.
    const auto& heights = *mesh.attributes.find<float>("height");
    ASSERT_EQ(heights.size(), mesh.vertices.size());
    for (std::size_t v = 0; v < heights.size(); ++v) ASSERT_NEAR(heights[v], mesh.vertices[v].z, 1e-5);
    EXPECT_EQ(mesh.triangle_attributes.find("face")->rows(), mesh.triangles.size());
    // The volume is that of the bar, up to the error of chords.
    double volume = 0;
    for (const Triangle& t : mesh.triangles)
      volume += dot(Vec3(mesh.vertices[t[0]]), cross(Vec3(mesh.vertices[t[1]]), Vec3(mesh.vertices[t[2]]))) / 6;
    EXPECT_NEAR(volume, 4, 6 * bend);
    // Edge midpoints are within the tolerance.
    for (const Triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        // The inverse twist maps the ends back onto the bar.
        const Vec3 a(mesh.vertices[t[k]]), b(mesh.vertices[t[(k + 1) % 3]]);
        const Vec3 ends[2] = {a, b};
        Vec3 before[2], middle;
        TwistMap(-0.5).map(ends, {before, {}, {}, {}});
        const Vec3 between = (before[0] + before[1]) * 0.5;
        twist.map(std::span(&between, 1), {std::span(&middle, 1), {}, {}, {}});
        ASSERT_LE(norm(middle - (a + b) * 0.5), 1.001 * bend + 1e-5);
      }
  }
  MeshDeformOptions few{0.001, 100};
  deform_mesh(bar(), twist, few, &report);
  EXPECT_FALSE(report.fine);
  EXPECT_THROW(deform_mesh(bar(), twist, {0.0}), ArgumentError);
}

TEST(DeformedMesh, NormalsStayAtRightAngles) {
  TriangleMesh mesh = bar();
  TriangleMesh soup;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      soup.vertices.push_back(mesh.vertices[v]);
      soup.normals.push_back(Vec3f(normal_of(mesh, t)));
    }
    const auto n = static_cast<std::uint32_t>(soup.vertices.size());
    soup.triangles.push_back({n - 3, n - 2, n - 1});
  }
  // A shear, and a reflection, which reverses triangles and normals.
  for (const double sign : {1.0, -1.0}) {
    const test::AffineSpaceMap map({Vec3{2, 0.3, 0}, Vec3{-0.7, 1, 0.4}, Vec3{0.2, 0, sign * 0.5}}, {3, 2, 1});
    MeshDeformReport report;
    const TriangleMesh moved = deform_mesh(soup, map, {}, &report);
    EXPECT_EQ(report.turned, sign > 0 ? 0 : moved.vertices.size());
    for (const Triangle& t : moved.triangles)
      for (const std::uint32_t v : t) EXPECT_NEAR(dot(normal_of(moved, t), Vec3(moved.normals[v])), 1, 1e-5);
  }
}

TEST(DeformedMesh, FarAwayNothingIsLost) {
  PointSet points;
  points.origin = {4e6, 5e6, 0};
  points.positions = {{0, 0, 0}, {0.125f, 0, 0}, {0, 0.25f, 0}};
  points.scanners = {{0, 0, 5}};
  points.colors.resize(3, {1, 2, 3});
  const test::AffineSpaceMap map({Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}, {1e6, 0, 3e6});
  const PointSet moved = deform_points(points, map);
  EXPECT_EQ(moved.colors, points.colors);
  EXPECT_TRUE(moved.scanners.empty());
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 before = points.origin + Vec3(points.positions[i]), after = moved.origin + Vec3(moved.positions[i]);
    EXPECT_LT(norm(after - before - Vec3{1e6, 0, 3e6}), 1e-6);
  }
}

TEST(DeformedMesh, WhereTheMapIsNotDefinedVerticesStay) {
  class Nowhere final : public SpaceMap {
   public:
    void map(std::span<const Vec3> x, const MappedPoints& wanted) const override {
      identity_map().map(x, wanted);
      for (Vec3& p : wanted.positions) p.x = std::numeric_limits<double>::quiet_NaN();
    }
  };
  MeshDeformReport report;
  const TriangleMesh mesh = deform_mesh(bar(), Nowhere(), {0.1}, &report);
  EXPECT_EQ(report.undefined, 8u);
  EXPECT_EQ(mesh.vertices, bar().vertices);
}

}  // namespace
}  // namespace sansmesh::inline v1
