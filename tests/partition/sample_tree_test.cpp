#include "sansmesh/partition/fit/sample_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sansmesh/core/morton.h"
#include "sansmesh/partition/fit/neighbour_walk.h"

namespace sansmesh::inline v1 {
namespace {

std::vector<Vec3f> random_points(std::size_t n) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<Vec3f> points(n);
  for (Vec3f& p : points) p = {uniform(generator), uniform(generator) * uniform(generator), uniform(generator)};
  return points;
}

SampleTree tree_of(const std::vector<Vec3f>& points, int depth) {
  SampleTree tree(points, {}, {0, 0, 0}, 1.0f, depth);
  tree.build_levels(depth);
  return tree;
}

TEST(SampleTree, CellsOfEveryLevelHoldTheirSamplesAndNoOthers) {
  const auto points = random_points(3000);
  SampleTree tree = tree_of(points, 5);
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
  const std::vector<std::uint32_t> order = tree.take_order();
  for (std::size_t i = 0; i < points.size(); ++i) {
    seen[order[i]] = true;
    EXPECT_EQ(tree.positions()[i], points[order[i]]);
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), true), 3000);
}

TEST(SampleTree, SamplesOfACellKeepTheirOrderHoweverManyThreadsSort) {
  // More samples than a thread sorts at a time, and cells few enough to hold samples of all chunks.
  std::mt19937 generator(3);
  std::vector<Vec3f> points(600000);
  for (Vec3f& p : points)
    for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<float>(generator() % 8) / 8;
  SampleTree tree = tree_of(points, 3);
  const std::vector<std::uint32_t> order = tree.take_order();
  const auto& cells = tree.level(3);
  EXPECT_EQ(cells.size(), 512u);
  EXPECT_TRUE(std::is_sorted(cells.code.begin(), cells.code.end()));
  for (std::size_t c = 0; c < cells.size(); ++c)
    EXPECT_TRUE(std::is_sorted(order.begin() + cells.begin[c], order.begin() + cells.begin[c + 1])) << c;
}

TEST(SampleTree, ChildrenAreTheCellsOfTheNextLevelWithTheSameSamples) {
  const SampleTree tree = tree_of(random_points(600000), 7);
  for (int l = 0; l < 7; ++l) {
    const auto &here = tree.level(l), &below = tree.level(l + 1);
    ASSERT_EQ(here.child.size(), here.size() + 1);
    EXPECT_EQ(here.child[here.size()], below.size());
    for (std::size_t c = 0; c < here.size(); ++c) {
      ASSERT_EQ(here.begin[c], below.begin[here.child[c]]);
      for (std::uint32_t k = here.child[c]; k < here.child[c + 1]; ++k) ASSERT_EQ(below.code[k] >> 3, here.code[c]);
    }
  }
}

TEST(SampleTree, CompanyIsTheMeanNumberOfSamplesInASamplesCell) {
  const SampleTree tree = tree_of(random_points(600000), 9);
  const std::vector<double> company = tree.company();
  ASSERT_EQ(company.size(), 10u);
  for (int l = 0; l <= 9; ++l) {
    const auto& begin = tree.level(l).begin;
    double squares = 0;
    for (std::size_t c = 0; c + 1 < begin.size(); ++c) squares += std::pow(begin[c + 1] - begin[c], 2);
    EXPECT_EQ(company[static_cast<std::size_t>(l)], squares / 600000) << l;
  }
}

TEST(NeighbourWalk, FindsTheCellsAroundACellWhereverItComesFrom) {
  const SampleTree tree = tree_of(random_points(2000), 5);
  std::vector<std::pair<int, std::uint32_t>> places;
  for (int l = 0; l <= 5; ++l)
    for (std::uint32_t c = 0; c < tree.level(l).size(); ++c) places.emplace_back(l, c);
  const auto check = [&] {
    NeighbourWalk walk(tree);
    for (const auto& [l, c] : places) {
      walk.go(l, c);
      const auto cell = morton_cell(tree.level(l).code[c]);
      for (int slot = 0; slot < 27; ++slot) {
        const std::int64_t x = std::int64_t{cell[0]} + slot % 3 - 1, y = std::int64_t{cell[1]} + slot / 3 % 3 - 1,
                           z = std::int64_t{cell[2]} + slot / 9 - 1;
        const std::int64_t n = std::int64_t{1} << l;
        std::int64_t want = -1;
        if (x >= 0 && y >= 0 && z >= 0 && x < n && y < n && z < n)
          want = tree.find(l, morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                          static_cast<std::uint32_t>(z)));
        ASSERT_EQ(walk.own()[static_cast<std::size_t>(slot)], want);
      }
      const std::uint64_t above = tree.level(l).code[c] >> 3;
      ASSERT_EQ(walk.parents()[13], l > 0 ? tree.find(l - 1, above) : 0);
    }
  };
  check();
  std::shuffle(places.begin(), places.end(), std::mt19937(4));
  check();
}

TEST(SampleTree, MortonCodesInvert) {
  std::mt19937 generator(2);
  for (int i = 0; i < 1000; ++i) {
    const std::uint32_t x = generator() & 0x1fffff, y = generator() & 0x1fffff, z = generator() & 0x1fffff;
    EXPECT_EQ(morton_cell(morton_code(x, y, z)), (std::array<std::uint32_t, 3>{x, y, z}));
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
