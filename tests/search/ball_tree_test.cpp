#include "sansmesh/search/ball_tree.h"

#include <gtest/gtest.h>

#include <random>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

TEST(BallTree, FindsWhatBruteForceFinds) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> coordinate(-3, 3), radius(0, 0.6f);
  for (const std::size_t count : {std::size_t{1}, std::size_t{8}, std::size_t{77}, std::size_t{5000}}) {
    std::vector<Vec3f> centers(count);
    std::vector<float> radii(count);
    for (std::size_t i = 0; i < count; ++i) {
      centers[i] = {coordinate(random), coordinate(random), coordinate(random)};
      radii[i] = radius(random);
    }
    const BallTree tree(centers, radii);
    for (int q = 0; q < 200; ++q) {
      Box3f box;
      box.extend({coordinate(random), coordinate(random), coordinate(random)});
      if (q % 3 != 0) box.extend(box.lower + Vec3f{radius(random), radius(random), radius(random)});
      std::vector<std::uint32_t> expected, found;
      for (std::size_t i = 0; i < count; ++i) {
        Vec3f gap;
        for (std::size_t k = 0; k < 3; ++k)
          gap[k] = std::max({box.lower[k] - centers[i][k], centers[i][k] - box.upper[k], 0.0f});
        if (gap.x * gap.x + gap.y * gap.y + gap.z * gap.z <= radii[i] * radii[i])
          expected.push_back(static_cast<std::uint32_t>(i));
      }
      tree.touching(box, found);
      EXPECT_EQ(found, expected);
      EXPECT_TRUE(tree.touching(box, expected.size(), found));
      EXPECT_EQ(found, expected);
      if (expected.empty()) continue;
      EXPECT_FALSE(tree.touching(box, expected.size() - 1, found));
    }
  }
}

TEST(BallTree, OfNothingFindsNothing) {
  std::vector<std::uint32_t> found{1, 2};
  Box3f box;
  box.extend({0, 0, 0});
  BallTree().touching(box, found);
  EXPECT_TRUE(found.empty());
  EXPECT_THROW(BallTree(std::vector<Vec3f>(2), std::vector<float>(1)), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
