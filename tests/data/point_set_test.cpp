#include "sansmesh/point_set.h"

#include <gtest/gtest.h>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

TEST(RemoveSamples, KeepsAttributesAndTrianglesTogether) {
  PointSet points;
  points.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
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
}  // namespace sansmesh::inline v1
