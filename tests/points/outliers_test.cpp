#include "sansmesh/points/cleaning/outliers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "points/shapes.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
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
  // The density decreases by four orders of magnitude from pole to pole.
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

TEST(Outliers, SparseFingersStay) {
  // Round parts with so few samples that the nearest ones of each look scattered in space.
  PointSet points = sample_sphere(40000, 1, 0, 1);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(0, 1);
  for (int finger = 0; finger < 6; ++finger)
    for (int i = 0; i < 40; ++i) {
      const float angle = 6.2831853f * u(random), side = 0.25f * static_cast<float>(finger) - 0.6f;
      points.positions.push_back({side + 0.09f * std::cos(angle), 0.09f * std::sin(angle), 1 + 0.8f * u(random)});
    }
  Progress progress;
  const auto mask = find_outliers(points, {}, progress);
  EXPECT_LE(count(mask, 40000, 40240), 12u);
}

TEST(Outliers, NoiseIsNotOutlying) {
  const PointSet points = sample_sphere(20000, 1, 0.04f, 7);
  Progress progress;
  const auto mask = find_outliers(points, {}, progress);
  EXPECT_LT(count(mask, 0, mask.size()), 40u);
}

TEST(Outliers, OffANoisySurfaceAreFound) {
  PointSet points = sample_sphere(20000, 1, 0.03f, 10);  // 1.2 spacings
  std::mt19937 random(11);
  std::uniform_real_distribution<float> u(6, 9);
  for (int i = 0; i < 200; ++i)
    points.positions.push_back(random_direction(random) * (1 + (i % 2 ? 1.0f : -1.0f) * 0.03f * u(random)));
  Progress progress;
  const auto mask = find_outliers(points, {}, progress);
  EXPECT_LT(count(mask, 0, 20000), 20u);
  EXPECT_GE(count(mask, 20000, 20200), 190u);
}

TEST(Outliers, NextToASurfaceAreFound) {
  PointSet points = sample_torus(20000, 1, 0.3f, 12);
  const float spacing = std::sqrt(4 * 9.8696f * 0.3f / 20000);
  std::mt19937 random(13);
  std::uniform_real_distribution<float> u(4, 8);
  for (int i = 0; i < 400; ++i) {
    const std::size_t at = static_cast<std::size_t>(i) * 50;
    points.positions.push_back(points.positions[at] + points.normals[at] * (spacing * u(random)));
  }
  Progress progress;
  const auto mask = find_outliers(points, {}, progress);
  EXPECT_LT(count(mask, 0, 20000), 5u);
  EXPECT_GE(count(mask, 20000, 20400), 360u);
}

TEST(Outliers, ScatteredClumpsAreFound) {
  PointSet points = sample_torus(20000, 1, 0.3f, 14);
  std::mt19937 random(15);
  std::normal_distribution<float> g(0, 0.03f);
  for (int clump = 0; clump < 10; ++clump) {
    const Vec3f center = random_direction(random) * 2;
    for (int i = 0; i < 40; ++i) points.positions.push_back(center + Vec3f{g(random), g(random), g(random)});
  }
  // A rod a few spacings thick is a surface, even with few samples.
  std::uniform_real_distribution<float> u(0, 1);
  for (int i = 0; i < 400; ++i) {
    const float angle = 6.2831853f * u(random);
    points.positions.push_back({0.06f * std::cos(angle), 0.06f * std::sin(angle), 1 + u(random)});
  }
  Progress progress;
  const auto mask = find_outliers(points, {}, progress);
  EXPECT_EQ(count(mask, 0, 20000), 0u);
  EXPECT_GE(count(mask, 20000, 20400), 380u);
  EXPECT_LT(count(mask, 20400, 20800), 12u);
}

TEST(Outliers, OneStepOfTheCoordinatesIsNoDistance) {
  // A wall seen by a low-resolution sensor: depths in steps of two spacings, some of them one step off.
  PointSet points;
  const float spacing = 0.01f, step = 0.02f;
  for (int i = 0; i < 150; ++i)
    for (int j = 0; j < 150; ++j) {
      const float x = spacing * static_cast<float>(i), y = spacing * static_cast<float>(j);
      const float wrong = (31 * i + 57 * j) % 101 == 0 ? 1.0f : 0.0f;
      points.positions.push_back({x, y, step * (std::round(0.1f * x / step) + wrong)});
    }
  const std::size_t wall = points.size();
  for (int i = 0; i < 10; ++i) points.positions.push_back({0.15f * static_cast<float>(i), 0.7f, 0.6f});
  Progress progress;
  const auto mask = find_outliers(points, {}, progress);
  EXPECT_EQ(count(mask, 0, wall), 0u);
  EXPECT_EQ(count(mask, wall, points.size()), 10u);
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
}  // namespace sansmesh::inline v1
