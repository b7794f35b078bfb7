#include "sansmesh/points/shape/cloud_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "points/shapes.h"

namespace sansmesh::inline v1 {
namespace {

// A rotated and translated box, whose shape must not change.
PointSet moved_box(Vec3f half, Vec3 offset) {
  PointSet points = sample_box(500, half, 1);
  const Vec3 n = normalized(Vec3{0.3, -0.5, 0.8});
  Vec3 t, b;
  tangent_frame(n, t, b);
  for (Vec3f& p : points.positions)
    p = Vec3f(t * static_cast<double>(p.x) + b * static_cast<double>(p.y) + n * static_cast<double>(p.z) + offset);
  return points;
}

TEST(CloudShape, OfFlatAndFullClouds) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(classify_shape({}), CloudShape::empty);
  EXPECT_EQ(classify_shape(cloud({{nan, 0, 0}})), CloudShape::empty);
  EXPECT_EQ(classify_shape(cloud({{1, 2, 3}})), CloudShape::point);
  EXPECT_EQ(classify_shape(cloud(std::vector<Vec3f>(9, {1e6f, 2, 3}))), CloudShape::point);
  EXPECT_EQ(classify_shape(cloud({{1, 2, 3}, {nan, 0, 0}, {2, 2, 3}})), CloudShape::line);
  EXPECT_EQ(classify_shape(cloud({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})), CloudShape::plane);
  EXPECT_EQ(classify_shape(cloud({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})), CloudShape::volume);
}

TEST(CloudShape, DoesNotDependOnScaleRotationOrPlace) {
  for (float scale : {1e-12f, 1.0f, 1e12f})
    for (const Vec3& offset : {Vec3{}, Vec3{3, -4, 5}, Vec3{100, 200, -300}}) {
      const Vec3 at = offset * static_cast<double>(scale);
      EXPECT_EQ(classify_shape(moved_box(Vec3f{1, 0, 0} * scale, at)), CloudShape::line);
      EXPECT_EQ(classify_shape(moved_box(Vec3f{1, 1, 0} * scale, at)), CloudShape::plane);
      EXPECT_EQ(classify_shape(moved_box(Vec3f{1, 1, 1e-3f} * scale, at)), CloudShape::volume);
      EXPECT_EQ(classify_shape(moved_box(Vec3f{1, 1e-3f, 1e-3f} * scale, at)), CloudShape::volume);
    }
}

TEST(CloudShape, PartsFarFromEachOtherAreNoLine) {
  const PointSet box = sample_box(500, {1, 1, 1}, 1);
  EXPECT_FALSE(find_far_parts(box));
  PointSet two = box;
  for (const Vec3f& p : box.positions) two.positions.push_back(p + Vec3f{1e9f, 0, 0});
  EXPECT_EQ(classify_shape(two), CloudShape::line) << "as far as extents tell";
  const auto parts = find_far_parts(two);
  ASSERT_TRUE(parts);
  EXPECT_NEAR(parts->apart, 1e9, 1e3);
  EXPECT_NEAR(parts->size, 2 * std::sqrt(3.0), 0.5);
  // If neither part is near zero, float does not resolve the points of either.
  PointSet both;
  for (const Vec3f& p : box.positions) {
    both.positions.push_back(p * 40.0f + Vec3f{1e9f, 0, 0});
    both.positions.push_back(p * 40.0f - Vec3f{1e9f, 0, 0});
  }
  EXPECT_TRUE(find_far_parts(both));
}

TEST(CloudShape, LinesAndPlanesWithGapsAreWhatTheyAre) {
  PointSet line, plane;
  for (int i = 0; i < 100; ++i) {
    const float at = static_cast<float>(i < 50 ? i : i + 1000);
    line.positions.push_back({at, 2 * at, 5});
    for (int j = 0; j < 10; ++j) plane.positions.push_back({at, static_cast<float>(j), 7});
  }
  EXPECT_FALSE(find_far_parts(line));
  EXPECT_FALSE(find_far_parts(plane));
  EXPECT_FALSE(find_far_parts(cloud({{0, 0, 0}, {1, 0, 0}})));
  EXPECT_FALSE(find_far_parts(cloud({{0, 0, 0}, {1e9f, 0, 0}, {0, 0, 0}})));
  EXPECT_FALSE(find_far_parts({}));
}

}  // namespace
}  // namespace sansmesh::inline v1
