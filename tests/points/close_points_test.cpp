#include "sansmesh/points/cleaning/close_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/points/sampling/subsample.h"

namespace sansmesh::inline v1 {
namespace {

std::vector<Vec3f> random_points(std::size_t n) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<Vec3f> points;
  for (std::size_t i = 0; i < n; ++i) points.push_back({uniform(random), uniform(random), uniform(random)});
  return points;
}

TEST(ClosePoints, RepresentativesAreApartAndNobodyIsFarFromTheirs) {
  std::vector<Vec3f> points = random_points(400);
  points.push_back(points[7]);
  points.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  for (const double distance : {0.0, 0.1}) {
    const std::vector<std::uint32_t> of = close_representatives(points, distance);
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(of[of[i]], of[i]);
      ASSERT_LE(of[i], i);
      if (of[i] != i) {
        EXPECT_LE(norm(points[i] - points[of[i]]), distance + 1e-6);
        continue;
      }
      for (std::size_t j = 0; j < i; ++j) {
        const bool close = norm(points[i] - points[j]) <= distance - 1e-6 || points[i] == points[j];
        EXPECT_FALSE(of[j] == j && close) << i << " and " << j;
      }
    }
    EXPECT_EQ(of[400], of[7]);
    EXPECT_EQ(of[401], 401u);
  }
  EXPECT_THROW(close_representatives(points, std::nan("")), ArgumentError);
}

TEST(ClosePoints, ComponentsOfHeapsOfPoints) {
  // A hundred thousand coincident points, as many in a cluster, and two rows of points ending at each.
  std::vector<Vec3f> points(100000, Vec3f{0, 0, 0});
  for (const Vec3f& p : random_points(100000)) points.push_back(p * 1e-7f + Vec3f{10, 0, 0});
  for (int k = 1; k < 5; ++k) {
    points.push_back({static_cast<float>(k), 0, 0});
    points.push_back({static_cast<float>(10 - k), 0, 0});
  }
  Progress progress;
  const CloudComponents apart = find_cloud_components(points, 1.1, progress);
  EXPECT_EQ(apart.points, (std::vector<std::size_t>{100004, 100004}));
  points.push_back({5, 0, 0});
  EXPECT_EQ(find_cloud_components(points, 1.1, progress).size(), 1u);
  EXPECT_EQ(find_cloud_components(points, 0, progress).points[0], 100000u);
}

/// Compares the components with those of a flood fill.
void expect_flooded(const std::vector<Vec3f>& points, double distance, const CloudComponents& found) {
  EXPECT_TRUE(std::is_sorted(found.points.rbegin(), found.points.rend()));
  std::vector<std::size_t> count(found.size());
  for (const std::uint32_t c : found.of_point) ++count[c];
  EXPECT_EQ(count, found.points);
  std::vector<std::uint32_t> flood(points.size(), ~0u);
  std::uint32_t parts = 0;
  for (std::size_t start = 0; start < points.size(); ++start) {
    if (flood[start] != ~0u) continue;
    std::vector<std::size_t> open{start};
    flood[start] = parts++;
    while (!open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      EXPECT_EQ(found.of_point[i], found.of_point[start]);
      for (std::size_t j = 0; j < points.size(); ++j)
        if (flood[j] == ~0u && norm(points[i] - points[j]) <= static_cast<float>(distance))
          flood[j] = flood[start], open.push_back(j);
    }
  }
  EXPECT_EQ(parts, found.size());
}

TEST(ClosePoints, ComponentsAreThoseOfBruteForceLargestFirst) {
  std::vector<Vec3f> points = random_points(3000);
  points.insert(points.end(), 100, points[17]);
  // Distances that connect hardly any points, a few, a hundred, and all.
  for (const double distance : {0.0, 0.01, 0.045, 0.2, 3.0}) {
    Progress progress;
    const CloudComponents found = find_cloud_components(points, distance, progress);
    if (distance < 0.05) {
      EXPECT_GT(found.size(), 10u);
    }
    expect_flooded(points, distance, found);
  }
}

TEST(Subsample, TakesSoManyEvenlyAndAlwaysTheSame) {
  const std::vector<std::uint32_t> chosen = scattered_choice(100000, 1000);
  ASSERT_EQ(chosen.size(), 1000u);
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  EXPECT_EQ(std::adjacent_find(chosen.begin(), chosen.end()), chosen.end());
  for (int tenth = 0; tenth < 10; ++tenth) {  // 100 each, with a standard deviation of 9.5
    const auto count = std::count_if(chosen.begin(), chosen.end(),
                                     [&](std::uint32_t i) { return static_cast<int>(i / 10000) == tenth; });
    EXPECT_NEAR(static_cast<double>(count), 100, 40);
  }
  EXPECT_EQ(scattered_choice(5, 9).size(), 5u);
  EXPECT_TRUE(scattered_choice(5, 0).empty());
  EXPECT_EQ(every_nth(7, 3), (std::vector<std::uint32_t>{0, 3, 6}));
  EXPECT_THROW(every_nth(7, 0), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
