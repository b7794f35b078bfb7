#include "sansmesh/points/sampling/poisson_discs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace sansmesh::inline v1 {
namespace {

/// Random points of a cube with this edge.
std::vector<Vec3> cloud(std::size_t n, double edge, Vec3 corner = {}, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, edge);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i)
    points.push_back(corner + Vec3{uniform(random), uniform(random), uniform(random)});
  return points;
}

/// Checks both properties of the definition by comparing all pairs; `slack`: rounding relative to the radius.
void expect_discs(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& kept, double radius,
                  double slack = 0) {
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_EQ(std::adjacent_find(kept.begin(), kept.end()), kept.end());
  for (const std::uint32_t k : kept) ASSERT_LT(k, points.size());
  for (std::size_t a = 0; a < kept.size(); ++a)
    for (std::size_t b = a + 1; b < kept.size(); ++b)
      ASSERT_GE(norm(points[kept[a]] - points[kept[b]]), radius * (1 - slack)) << kept[a] << " and " << kept[b];
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool covered = std::any_of(kept.begin(), kept.end(), [&](std::uint32_t k) {
      return k == i || norm(points[k] - points[i]) < radius * (1 + slack);
    });
    ASSERT_TRUE(covered) << "there is room for " << i;
  }
}

TEST(PoissonDiscs, KeepTheirDistanceAndLeaveNoRoom) {
  const std::vector<Vec3> points = cloud(3000, 1, {-0.5, -0.5, -0.5});
  std::size_t last = points.size() + 1;
  for (const double radius : {1e-6, 0.03, 0.1, 0.4}) {
    const auto kept = poisson_discs(points, radius);
    expect_discs(points, kept, radius);
    EXPECT_LT(kept.size(), last) << radius;
    last = kept.size();
  }
  EXPECT_EQ(poisson_discs(points, 1e-6).size(), points.size());
  EXPECT_EQ(poisson_discs(points, 10).size(), 1u);
  EXPECT_EQ(poisson_discs(points, std::numeric_limits<double>::infinity()).size(), 1u);
}

TEST(PoissonDiscs, AreTheSameEveryTimeAndDoNotFollowTheArray) {
  std::vector<Vec3> line;
  for (int i = 0; i < 1000; ++i) line.push_back({0.001 * i, 0, 0});
  const double radius = 0.0095;
  const auto kept = poisson_discs(line, radius);
  EXPECT_EQ(poisson_discs(line, radius), kept);
  expect_discs(line, kept, radius);
  // In array order, each would be the tenth after the previous one.
  std::size_t tenths = 0;
  for (std::size_t i = 1; i < kept.size(); ++i) tenths += kept[i] - kept[i - 1] == 10;
  EXPECT_LT(tenths + 5, kept.size());
}

TEST(PoissonDiscs, OfFewOrEqualPoints) {
  EXPECT_TRUE(poisson_discs({}, 1).empty());
  for (std::size_t n = 1; n < 40; ++n) {
    const std::vector<Vec3> points = cloud(n, 1);
    expect_discs(points, poisson_discs(points, 0.3), 0.3);
    EXPECT_EQ(poisson_discs(std::vector<Vec3>(n, {1, 2, 3}), 1e-3).size(), 1u) << n;
  }
  const std::vector<Vec3> apart{{0, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(poisson_discs(apart, 1).size(), 2u) << "exactly the radius apart is far enough";
}

TEST(PoissonDiscs, CellsBeyondTheBitsOfTheHashDoNotMix) {
  // Clusters whose cells agree in the last 21 bits: wrong look-ups would block or miss points.
  const double radius = 0.1, period = radius * (1 << 21);
  std::vector<Vec3> points;
  for (const Vec3& corner : {Vec3{}, Vec3{period, 0, 0}, Vec3{0, -period, period}, Vec3{-3 * period, 5 * period, 0}})
    for (const Vec3& p : cloud(500, 1, corner)) points.push_back(p);
  expect_discs(points, poisson_discs(points, radius), radius);
  // Across the wrap-around of the bits.
  for (const double at : {0.0, period / 2, period, -period}) {
    const std::vector<Vec3> near = cloud(1500, 1, {at - 0.5, -at - 0.5, at - 0.5});
    expect_discs(near, poisson_discs(near, radius), radius);
  }
}

TEST(PoissonDiscs, HugeCoordinates) {
  for (const double far : {1e7, -1e9, 1e11}) {
    const std::vector<Vec3> points = cloud(1500, 1, {far, far, -far});
    expect_discs(points, poisson_discs(points, 0.1), 0.1);
  }
  // Beyond the range of cell numbers all points are distinct.
  const std::vector<Vec3> points = cloud(300, 1e40, {-5e39, -5e39, -5e39});
  EXPECT_EQ(poisson_discs(points, 1e-3).size(), points.size());
  expect_discs(points, poisson_discs(points, 1e39), 1e39);
}

}  // namespace
}  // namespace sansmesh::inline v1
