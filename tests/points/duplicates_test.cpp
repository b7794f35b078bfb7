#include "sansmesh/points/duplicates.h"

#include <gtest/gtest.h>

#include <limits>

#include "points/shapes.h"
#include "sansmesh/core/error.h"

namespace sansmesh {
namespace {

PointSet cloud(std::vector<Vec3f> positions) {
  PointSet points;
  points.positions = std::move(positions);
  return points;
}

// A box rotated and moved: its shape must not change.
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

TEST(Duplicates, AreMarkedAfterTheFirst) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  const PointSet points = cloud({{0, 1, 2}, {3, 4, 5}, {-0.0f, 1, 2}, {inf, 0, 0}, {3, 4, 5}, {3, 4, 5}, {5, 4, 3}});
  EXPECT_EQ(find_duplicates(points), (std::vector<std::uint8_t>{0, 0, 1, 1, 1, 1, 0}));
  EXPECT_EQ(count_unique(points), 3u);
  EXPECT_EQ(count_non_finite(points), 1u);
  EXPECT_EQ(count_unique({}), 0u);
}

TEST(Duplicates, CountOnALattice) {
  PointSet points;
  for (int i = 0; i < 30000; ++i)
    points.positions.push_back(
        {static_cast<float>(i % 10), static_cast<float>(i / 10 % 20), static_cast<float>(i % 3)});
  EXPECT_EQ(count_unique(points), 600u);
  PointSet kept = points;
  remove_samples(kept, find_duplicates(points));
  EXPECT_EQ(kept.size(), 600u);
  EXPECT_EQ(count_unique(kept), 600u);
}

TEST(RemoveSamples, KeepsAttributesAndTrianglesTogether) {
  PointSet points = cloud({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}});
  points.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 1}, {0, 1, 0}};
  points.attributes.set("confidence", std::vector<float>{0, 1, 2, 3, 4});
  points.attributes.set("pair", std::vector<std::int64_t>{0, 0, 1, 1, 2, 2, 3, 3, 4, 4}, 2);
  points.colors.assign(5, {1, 2, 3});
  points.scan_of_point = {0, 1, 2, 3, 4};
  points.triangles = {{0, 1, 2}, {0, 2, 4}, {2, 3, 4}};
  points.triangle_attributes.set("number", std::vector<std::uint8_t>{7, 8, 9});
  remove_samples(points, {0, 1, 0, 0, 0});
  EXPECT_EQ(points.size(), 4u);
  EXPECT_EQ(*points.attributes.find<float>("confidence"), (std::vector<float>{0, 2, 3, 4}));
  EXPECT_EQ(*points.attributes.find<std::int64_t>("pair"), (std::vector<std::int64_t>{0, 0, 2, 2, 3, 3, 4, 4}));
  EXPECT_EQ(*points.triangle_attributes.find<std::uint8_t>("number"), (std::vector<std::uint8_t>{8, 9}));
  EXPECT_EQ(points.normals[1], (Vec3f{0, 0, 1}));
  EXPECT_EQ(points.colors.size(), 4u);
  EXPECT_EQ(points.scan_of_point, (std::vector<std::uint16_t>{0, 2, 3, 4}));
  EXPECT_EQ(points.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 3}, {1, 2, 3}}));
  EXPECT_THROW(remove_samples(points, {0, 1}), ArgumentError);
  points.attributes.clear();
  points.attributes.set("short", std::vector<float>{1});
  EXPECT_THROW(remove_samples(points, std::vector<std::uint8_t>(points.size(), 1)), ArgumentError);
}

}  // namespace
}  // namespace sansmesh
