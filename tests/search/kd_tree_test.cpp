#include "sansmesh/search/kd_tree.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "sansmesh/search/brute_force.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

std::vector<Vec3f> random_points(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> u(-1, 1);
  std::vector<Vec3f> points(n);
  for (Vec3f& p : points) p = {u(random), u(random), u(random)};
  return points;
}

// Small integers: many equal distances and duplicates.
std::vector<Vec3f> lattice_points(std::size_t n, unsigned seed) {
  std::vector<Vec3f> points = random_points(n, seed);
  for (Vec3f& p : points) p = {std::round(3 * p.x), std::round(3 * p.y), std::round(3 * p.z)};
  return points;
}

// Clusters of very different density, one of them a line.
std::vector<Vec3f> uneven_points(std::size_t n, unsigned seed) {
  std::vector<Vec3f> points = random_points(n, seed);
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 3 == 0) points[i] = points[i] * 1e-3f + Vec3f{5, 0, 0};
    if (i % 7 == 0) points[i] = {points[i].x * 100, 2, 2};
  }
  return points;
}

void expect_same_answers(const std::vector<Vec3f>& points, const std::vector<Vec3f>& queries) {
  const KdTree tree(points);
  const BruteForce oracle(points);
  ASSERT_EQ(tree.size(), oracle.size());
  for (const Vec3f& q : queries) {
    for (std::size_t k : {std::size_t{1}, std::size_t{2}, std::size_t{9}, std::size_t{40}, points.size() + 3}) {
      std::vector<Neighbour> found(k), expected(k);
      found.resize(tree.nearest(q, found));
      expected.resize(oracle.nearest(q, expected));
      ASSERT_EQ(found, expected) << "k = " << k;
    }
    ASSERT_EQ(tree.nearest(q), oracle.nearest(q));
    for (float radius : {0.0f, 0.1f, 1.0f, 3.0f, 1e9f}) {
      std::vector<Neighbour> found, expected;
      tree.within(q, radius, found);
      oracle.within(q, radius, expected);
      ASSERT_EQ(found, expected) << "radius = " << radius;
      ASSERT_EQ(tree.count_within(q, radius), expected.size());
    }
  }
}

TEST(KdTree, AnswersLikeBruteForce) {
  for (std::size_t n : {1u, 2u, 7u, 8u, 9u, 63u, 64u, 65u, 130u, 511u, 513u, 2000u}) {
    SCOPED_TRACE(n);
    expect_same_answers(random_points(n, 1), random_points(20, 2));
    expect_same_answers(lattice_points(n, 3), lattice_points(20, 4));
    expect_same_answers(uneven_points(n, 5), uneven_points(20, 6));
  }
}

TEST(KdTree, EveryPointFindsItself) {
  const std::vector<Vec3f> points = random_points(3000, 7);
  const KdTree tree(points);
  for (std::uint32_t i = 0; i < points.size(); ++i) EXPECT_EQ(tree.nearest(points[i]), (Neighbour{0, i}));
}

TEST(KdTree, BatchAnswersLikeBruteForceOnTheReorderedPoints) {
  for (const auto& points : {random_points(1500, 8), lattice_points(1500, 9), uneven_points(1500, 10)}) {
    const KdTree tree(points);
    const std::vector<Vec3f> reordered = tree.positions();
    for (std::size_t s = 0; s < reordered.size(); ++s) ASSERT_EQ(reordered[s], points[tree.order()[s]]);
    const BruteForce oracle(reordered);
    for (std::size_t k : {1u, 6u, 33u, 5000u}) {
      std::vector<std::vector<Neighbour>> found(points.size());
      tree.for_each_nearest(k, [&](std::uint32_t slot, std::span<const Neighbour> neighbours) {
        EXPECT_TRUE(found[slot].empty());
        found[slot].assign(neighbours.begin(), neighbours.end());
      });
      for (std::size_t s = 0; s < points.size(); s += 37) {
        std::vector<Neighbour> expected(k);
        expected.resize(oracle.nearest(reordered[s], expected));
        ASSERT_EQ(found[s], expected);
      }
    }
  }
}

TEST(KdTree, OrderIsAPermutationAndIndependentOfTheNumberOfThreads) {
  const std::vector<Vec3f> points = lattice_points(50000, 11);
  const KdTree one(points);
  test::expect_equal_for_any_threads([&] {
    const KdTree tree(points);
    return std::vector(tree.order().begin(), tree.order().end());
  });
  std::vector<bool> seen(points.size());
  for (std::uint32_t i : one.order()) {
    EXPECT_FALSE(seen[i]);
    seen[i] = true;
  }
  EXPECT_EQ(one.order().size(), points.size());
}

TEST(KdTree, LeavesOutWhatIsNotFinite) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  std::vector<Vec3f> points = random_points(300, 12);
  for (std::size_t i = 0; i < points.size(); i += 3) points[i] = {nan, i % 2 ? inf : 0, -inf};
  expect_same_answers(points, random_points(10, 13));
  const KdTree tree(points);
  EXPECT_EQ(tree.size(), 200u);
  EXPECT_FALSE(tree.nearest({nan, 0, 0}));
  EXPECT_EQ(tree.count_within({0, inf, 0}, 1), 0u);
  EXPECT_EQ(tree.count_within({0, 0, 0}, nan), 0u);
}

TEST(KdTree, EmptyAndCoincident) {
  const KdTree empty;
  EXPECT_EQ(empty.size(), 0u);
  EXPECT_FALSE(empty.nearest({0, 0, 0}));
  EXPECT_FALSE(KdTree(std::span<const Vec3f>{}).nearest({0, 0, 0}));
  empty.for_each_nearest(3, [](std::uint32_t, std::span<const Neighbour>) { FAIL(); });
  const std::vector<Vec3f> same(1000, Vec3f{1, 2, 3});
  const KdTree tree(same);
  std::vector<Neighbour> found(5);
  EXPECT_EQ(tree.nearest({1, 2, 4}, found), 5u);
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(found[i], (Neighbour{1, i}));
  EXPECT_EQ(tree.nearest({0, 0, 0}, {}), 0u);
}

}  // namespace
}  // namespace sansmesh::inline v1
