#include "sansmesh/mesh_measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/mesh_shapes.h"

namespace sansmesh::inline v1 {
namespace {

TriangleMesh triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  TriangleMesh mesh;
  mesh.vertices = {a, b, c};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

TEST(MeshQuality, TheEquilateralTriangleIsTheBest) {
  const MeshQuality q = measure_quality(triangle({0, 0, 0}, {2, 0, 0}, {1, std::sqrt(3.0f), 0}));
  EXPECT_NEAR(q.aspect_mean, 1, 1e-6);
  EXPECT_NEAR(q.aspect_deviation, 0, 1e-6);
  EXPECT_NEAR(q.smallest_angle, 60, 1e-5);
  EXPECT_NEAR(q.area, std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(q.edge_mean, 2, 1e-6);
  EXPECT_EQ(q.small_angle_share, 0);
}

TEST(MeshQuality, RightTriangleInEveryOrderOfItsCorners) {
  // Legs 1 and 1: AR = √2 (2 + √2) / (4 √3 · 1/2).
  const double expected = std::sqrt(2.0) * (2 + std::sqrt(2.0)) / (2 * std::sqrt(3.0));
  const Vec3f p[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (int k = 0; k < 3; ++k) {
    const MeshQuality q = measure_quality(triangle(p[k], p[(k + 1) % 3], p[(k + 2) % 3]));
    EXPECT_NEAR(q.aspect_max, expected, 1e-6);
    EXPECT_NEAR(q.smallest_angle_mean, 45, 1e-5);
  }
}

TEST(MeshQuality, CountsSmallAnglesAndLeavesOutTrianglesWithoutArea) {
  TriangleMesh mesh = triangle({0, 0, 0}, {10, 0, 0}, {5, 0.5f, 0});
  mesh.vertices.push_back({20, 0, 0});
  mesh.vertices.push_back({5, 20, 0});
  mesh.triangles.push_back({0, 1, 4});
  mesh.triangles.push_back({0, 1, 3});
  const MeshQuality q = measure_quality(mesh);
  EXPECT_EQ(q.triangles, 2u);
  EXPECT_DOUBLE_EQ(q.small_angle_share, 0.5);
  EXPECT_NEAR(q.smallest_angle, std::atan(0.1) * 180 / std::numbers::pi, 1e-5);
  EXPECT_EQ(measure_quality({}).area, 0);
}

TEST(MeshQuality, AreaAndVolumeOfTheSphereConverge) {
  double area_error = 0, volume_error = 0;
  for (int level = 3; level <= 5; ++level) {
    TriangleMesh mesh = test::octasphere(level);
    for (Vec3f& v : mesh.vertices) v = 3.0f * v + Vec3f{100, -50, 20};
    const MeshQuality q = measure_quality(mesh);
    const double area = std::abs(q.area - 36 * std::numbers::pi), volume = std::abs(q.volume - 36 * std::numbers::pi);
    if (level > 3) {
      EXPECT_NEAR(area_error / area, 4, 0.5);  // second order in the edge length
      EXPECT_NEAR(volume_error / volume, 4, 0.5);
    }
    area_error = area, volume_error = volume;
  }
  TriangleMesh inside_out = test::octasphere(2);
  for (Triangle& t : inside_out.triangles) std::swap(t[0], t[1]);
  EXPECT_LT(measure_quality(inside_out).volume, 0);
}

}  // namespace
}  // namespace sansmesh::inline v1
