#include "sansmesh/points/duplicates.h"

#include <gtest/gtest.h>

#include <limits>

#include "points/shapes.h"

namespace sansmesh {
namespace {

TEST(Duplicates, AreMarkedAfterTheFirst) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  const PointSet points = cloud({{0, 1, 2}, {3, 4, 5}, {-0.0f, 1, 2}, {inf, 0, 0}, {3, 4, 5}, {3, 4, 5}, {5, 4, 3}});
  EXPECT_EQ(find_duplicates(points), (std::vector<std::uint8_t>{0, 0, 1, 1, 1, 1, 0}));
  EXPECT_EQ(count_unique(points), 3u);
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

}  // namespace
}  // namespace sansmesh
