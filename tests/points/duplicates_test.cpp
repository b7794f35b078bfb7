#include "sansmesh/points/cleaning/duplicates.h"

#include <gtest/gtest.h>

#include <limits>

#include "points/shapes.h"

namespace sansmesh::inline v1 {
namespace {

TEST(Duplicates, AreMarkedAfterTheFirst) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  const PointSet points = cloud({{0, 1, 2}, {3, 4, 5}, {-0.0f, 1, 2}, {inf, 0, 0}, {3, 4, 5}, {3, 4, 5}, {5, 4, 3}});
  EXPECT_EQ(find_duplicates(points), (std::vector<std::uint8_t>{0, 0, 1, 1, 1, 1, 0}));
  EXPECT_EQ(count_unique(points), 3u);
  EXPECT_EQ(count_unique({}), 0u);
}

TEST(Duplicates, ShareOfManyAtOnePlaceAndOfPairs) {
  PointSet points = sample_box(150000, {1, 1, 1}, 1);
  EXPECT_LT(duplicate_share(points), 0.001);
  PointSet pairs = points;
  pairs.positions.insert(pairs.positions.end(), points.positions.begin(), points.positions.end());
  EXPECT_NEAR(duplicate_share(pairs), 0.5, 0.05);
  // A sample of positions contains a given position or, usually, does not.
  for (const Vec3f& place : {Vec3f{0, 0, 0}, Vec3f{1, 2, 3}, Vec3f{0.3f, -5, 1e-3f}}) {
    PointSet camera = points;
    camera.positions.insert(camera.positions.begin() + 1000, 50000, place);
    EXPECT_NEAR(duplicate_share(camera), 0.25, 0.05);
  }
}

TEST(Duplicates, ShareIsThatOfAllColumnsOfAScan) {
  // Rows of ten times 64 samples: steps of 64 would never visit some columns.
  PointSet scan = sample_box(128000, {1, 1, 1}, 1);
  for (std::size_t i = 0; i < scan.size(); ++i)
    if (i % 640 > 320 && i % 640 < 384) scan.positions[i] = {};
  EXPECT_NEAR(duplicate_share(scan), 63.0 / 640, 0.01);
}

TEST(Duplicates, DifferentPositionsKeepTheirOrder) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const PointSet points = cloud({{3, 4, 5}, {nan, 0, 0}, {0, 1, 2}, {3, 4, 5}, {-0.0f, 1, 2}, {1, 1, 1}});
  EXPECT_EQ(different_positions(points.positions), (std::vector<Vec3f>{{3, 4, 5}, {0, 1, 2}, {1, 1, 1}}));
  EXPECT_TRUE(different_positions({}).empty());
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

}  // namespace
}  // namespace sansmesh::inline v1
