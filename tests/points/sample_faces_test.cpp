#include "sansmesh/points/sampling/sample_faces.h"

#include "sansmesh/points/shape/face_shape.h"
#include "support/any_threads.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sansmesh::inline v1 {
namespace {

/// A rectangle 3 × 1 of two triangles, a parallel one of four times the area, and two invalid triangles.
PointSet rectangles() {
  PointSet mesh;
  mesh.positions = {{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {0, 1, 0}, {0, 0, 5}, {6, 0, 5}, {6, 2, 5}, {0, 2, 5}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 1, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 99}};
  return mesh;
}

TEST(SampleFaces, LieOnTheirTriangleAndAreEvenOverTheArea) {
  const PointSet mesh = rectangles();
  const auto samples = sample_triangles(mesh.positions, mesh.triangles, 20000);
  ASSERT_EQ(samples.size(), 20000u);
  std::size_t low = 0, left = 0;
  for (const FaceSample& s : samples) {
    const Triangle& t = mesh.triangles[s.triangle];
    EXPECT_NE(s.triangle, 2u);
    EXPECT_NE(s.triangle, 5u);
    const Vec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    EXPECT_LT(norm(s.position - (a * double(1 - s.u - s.v) + b * double(s.u) + c * double(s.v))), 1e-5);
    EXPECT_EQ(s.normal, (Vec3f{0, 0, 1}));
    const double z = s.position[2];
    EXPECT_TRUE(z == 0 || z == 5);
    low += z == 0;
    left += z == 5 && s.position[0] < 3;
  }
  EXPECT_NEAR(static_cast<double>(low), 4000, 20);    // a fifth of the area
  EXPECT_NEAR(static_cast<double>(left), 8000, 250);  // half of the large one
}

TEST(SampleFaces, SameForAnyNumberOfThreads) {
  const PointSet mesh = rectangles();
  test::compare_threads([&] { return sample_triangles(mesh.positions, mesh.triangles, 30000); },
                        [](const auto& one, const auto& many) {
                          ASSERT_EQ(one.size(), many.size());
                          for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one[i].position, many[i].position);
                        });
}

TEST(SampleFaces, NothingToSample) {
  PointSet mesh = rectangles();
  mesh.triangles = {{1, 1, 2}, {0, 1, 99}};
  EXPECT_EQ(sample_faces(mesh, 100).size(), 0u);
  mesh.triangles = {{0, 1, 2}};
  mesh.positions[1][0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(sample_faces(mesh, 100).size(), 0u);
}

TEST(SampleFaces, CarriesColours) {
  PointSet mesh = rectangles();
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.colors.assign(mesh.size(), {0, 0, 0});
  mesh.colors[1] = mesh.colors[2] = {200, 100, 0};
  const PointSet cloud = sample_faces(mesh, 500);
  ASSERT_EQ(cloud.colors.size(), 500u);
  for (std::size_t i = 0; i < cloud.size(); ++i) EXPECT_NEAR(cloud.colors[i][0], 200 * cloud.positions[i][0] / 3, 1.5);
}

/// A square of n × n quads.
PointSet grid(std::uint32_t n) {
  PointSet mesh;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) mesh.positions.push_back(Vec3f(float(i), float(j), 0));
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t v = j * (n + 1) + i;
      mesh.triangles.push_back({v, v + 1, v + n + 2});
      mesh.triangles.push_back({v, v + n + 2, v + n + 1});
    }
  return mesh;
}

TEST(SampleFaces, VerticesOfAMeshedScanSuffice) {
  EXPECT_TRUE(vertices_are_dense(grid(60)));
  EXPECT_FALSE(vertices_are_dense(grid(10))) << "121 vertices are too few";
  EXPECT_FALSE(vertices_are_dense(rectangles()));
  PointSet fan = grid(60);  // a fine part beside one triangle of the same total area
  fan.positions.insert(fan.positions.end(), {{100, 0, 0}, {200, 0, 0}, {100, 70, 0}});
  fan.triangles.push_back({3721, 3722, 3723});
  EXPECT_FALSE(vertices_are_dense(fan));
}

TEST(SampleFaces, NormalsFromFacesAreWeightedByArea) {
  PointSet mesh;  // a large triangle facing z and a small one facing x share two corners
  mesh.positions = {{0, 0, 0}, {0, 2, 0}, {-3, 0, 0}, {0, 0, -1}, {7, 7, 7}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
  set_normals_from_faces(mesh);
  const Vec3f expected = normalized(Vec3f{-1 * 2.0f * 1.0f, 0, 3.0f * 2.0f});
  for (const std::size_t shared : {0u, 1u}) {
    EXPECT_NEAR(std::abs(mesh.normals[shared][0]), std::abs(expected[0]), 1e-6);
    EXPECT_NEAR(mesh.normals[shared][2], expected[2], 1e-6);
  }
  EXPECT_EQ(mesh.normals[2], (Vec3f{0, 0, 1}));
  EXPECT_EQ(mesh.normals[4], (Vec3f{}));
}

}  // namespace
}  // namespace sansmesh::inline v1
