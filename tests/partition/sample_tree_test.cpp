#include "sansmesh/partition/sample_tree.h"

#include <gtest/gtest.h>

#include <random>

namespace sansmesh {
namespace {

std::vector<Vec3f> random_points(std::size_t n) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<Vec3f> points(n);
  for (Vec3f& p : points) p = {uniform(generator), uniform(generator) * uniform(generator), uniform(generator)};
  return points;
}

TEST(SampleTree, CellsOfEveryLevelHoldTheirSamplesAndNoOthers) {
  const auto points = random_points(3000);
  const SampleTree tree(points, {}, {0, 0, 0}, 1.0f, 5);
  for (int l = 0; l <= 5; ++l) {
    const auto& level = tree.level(l);
    std::size_t total = 0;
    for (std::size_t c = 0; c < level.size(); ++c) {
      const auto cell = morton_cell(level.code[c]);
      for (std::uint32_t i = level.begin[c]; i < level.begin[c + 1]; ++i, ++total)
        for (std::size_t k = 0; k < 3; ++k)
          ASSERT_EQ(static_cast<std::uint32_t>(tree.positions()[i][k] * static_cast<float>(1 << l)), cell[k]);
    }
    EXPECT_EQ(total, points.size());
  }
  std::vector<bool> seen(points.size(), false);
  for (std::size_t i = 0; i < points.size(); ++i) {
    seen[tree.order()[i]] = true;
    EXPECT_EQ(tree.positions()[i], points[tree.order()[i]]);
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), true), 3000);
}

TEST(SampleTree, NeighboursFromTheParentsAreTheCellsAround) {
  const auto points = random_points(2000);
  const SampleTree tree(points, {}, {0, 0, 0}, 1.0f, 4);
  std::vector<SampleTree::Neighbours> around{tree.root_neighbours()};
  for (int l = 0; l < 4; ++l) {
    std::vector<SampleTree::Neighbours> below(tree.level(l + 1).size());
    for (std::size_t p = 0; p < tree.level(l).size(); ++p)
      for (std::uint32_t c = tree.level(l).child[p]; c < tree.level(l).child[p + 1]; ++c) {
        below[c] = tree.child_neighbours(l, around[p], c);
        const auto cell = morton_cell(tree.level(l + 1).code[c]);
        for (int slot = 0; slot < 27; ++slot) {
          const std::int64_t x = std::int64_t{cell[0]} + slot % 3 - 1, y = std::int64_t{cell[1]} + slot / 3 % 3 - 1,
                             z = std::int64_t{cell[2]} + slot / 9 - 1;
          const std::int64_t n = 2 << l;
          std::int64_t want = -1;
          if (x >= 0 && y >= 0 && z >= 0 && x < n && y < n && z < n)
            want = tree.find(l + 1, morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                                static_cast<std::uint32_t>(z)));
          ASSERT_EQ(below[c][static_cast<std::size_t>(slot)], want);
        }
      }
    around = std::move(below);
  }
}

TEST(SampleTree, MortonCodesInvert) {
  std::mt19937 generator(2);
  for (int i = 0; i < 1000; ++i) {
    const std::uint32_t x = generator() & 0x1fffff, y = generator() & 0x1fffff, z = generator() & 0x1fffff;
    EXPECT_EQ(morton_cell(morton_code(x, y, z)), (std::array<std::uint32_t, 3>{x, y, z}));
  }
}

}  // namespace
}  // namespace sansmesh
