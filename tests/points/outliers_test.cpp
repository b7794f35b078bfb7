#include "sansmesh/points/outliers.h"

#include <gtest/gtest.h>

#include <numeric>

#include "points/shapes.h"
#include "sansmesh/core/error.h"

namespace sansmesh {
namespace {

std::size_t count(const std::vector<std::uint8_t>& mask, std::size_t first, std::size_t last) {
  return std::accumulate(mask.begin() + static_cast<std::ptrdiff_t>(first),
                         mask.begin() + static_cast<std::ptrdiff_t>(last), std::size_t{0});
}

TEST(Outliers, AreFoundAmongSurfaceSamples) {
  PointSet points = sample_torus(20000, 1, 0.3f, 1);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> u(-2, 2);
  for (int i = 0; i < 500; ++i) points.positions.push_back({u(random), u(random), u(random)});
  Progress progress;
  const auto mask = find_outliers(points, {}, progress);
  EXPECT_EQ(count(mask, 0, 20000), 0u);
  EXPECT_GE(count(mask, 20000, 20500), 475u);
}

TEST(Outliers, SmallDetachedClustersAreFoundAndLargeOnesKept) {
  PointSet points = sample_sphere(10000, 1, 0, 3);
  append(points, sample_sphere(8, 0.01f, 0, 4, {1.5f, 0, 0}));
  append(points, sample_sphere(200, 0.1f, 0, 5, {0, 1.5f, 0}));
  Progress progress;
  const auto mask = find_outliers(points, {}, progress);
  EXPECT_EQ(count(mask, 0, 10000), 0u);
  EXPECT_EQ(count(mask, 10000, 10008), 8u);
  EXPECT_EQ(count(mask, 10008, 10208), 0u);
}

TEST(Outliers, SparseRegionsStay) {
  // Density falls by four orders of magnitude from one pole to the other.
  std::mt19937 random(6);
  std::uniform_real_distribution<float> u(0, 1);
  PointSet points;
  while (points.size() < 20000) {
    const Vec3f d = random_direction(random);
    if (u(random) < std::pow(10.0f, -2 * (d.z + 1))) points.positions.push_back(d);
  }
  Progress progress;
  const auto mask = find_outliers(points, {}, progress);
  EXPECT_LT(count(mask, 0, mask.size()), 20u);
}

TEST(Outliers, NoiseIsNotOutlying) {
  const PointSet points = sample_sphere(20000, 1, 0.04f, 7);
  Progress progress;
  const auto mask = find_outliers(points, {}, progress);
  EXPECT_LT(count(mask, 0, mask.size()), 40u);
}

TEST(Outliers, TinyCloudsAreKeptWhole) {
  Progress progress;
  for (std::size_t n : {0u, 1u, 5u, 11u}) {
    const auto mask = find_outliers(sample_sphere(n, 1, 0, 8), {}, progress);
    EXPECT_EQ(count(mask, 0, n), 0u);
  }
  PointSet points = sample_sphere(100, 1, 0, 9);
  points.positions[3] = {std::nanf(""), 0, 0};
  const auto mask = find_outliers(points, {}, progress);
  EXPECT_EQ(mask[3], 1);
  EXPECT_EQ(count(mask, 0, 100), 1u);
  points.positions.assign(100, {1, 1, 1});
  EXPECT_EQ(count(find_outliers(points, {}, progress), 0, 100), 0u);
  EXPECT_THROW(find_outliers(points, {.isolation = 1}, progress), ArgumentError);
}

}  // namespace
}  // namespace sansmesh
