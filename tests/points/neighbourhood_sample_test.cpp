#include "sansmesh/points/statistics/neighbourhood_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <random>

#include "points/shapes.h"
#include "sansmesh/points/statistics/spacing.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

/// Distinct offsets of all positions from a point, in the order of neighbourhoods.
std::vector<Vec3f> all_offsets(const std::vector<Vec3f>& points, const Vec3f& place) {
  std::vector<Vec3f> offsets;
  for (const Vec3f& p : points)
    if (is_finite(p)) offsets.push_back(p - place);
  std::sort(offsets.begin(), offsets.end(), [](const Vec3f& a, const Vec3f& b) {
    const float da = squared_norm(a), db = squared_norm(b);
    return da != db ? da < db : a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  });
  offsets.erase(std::unique(offsets.begin(), offsets.end()), offsets.end());
  return offsets;
}

std::vector<Vec3f> ball_cluster(std::size_t n, float radius, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> in(-radius, radius);
  std::vector<Vec3f> points(n);
  for (Vec3f& p : points) p = {in(random), in(random), in(random)};
  return points;
}

/// Every neighbourhood contains the nearest positions of the whole cloud, and no more than requested.
void expect_nearest(const std::vector<Vec3f>& points, std::size_t size) {
  const std::vector<Neighbourhood> sample = sample_neighbourhoods(points, 40, size);
  ASSERT_FALSE(sample.empty());
  for (const Neighbourhood& n : sample) {
    ASSERT_LE(n.offsets.size(), size);
    std::vector<Vec3f> nearest = all_offsets(points, n.center);
    ASSERT_GE(nearest.size(), n.offsets.size());
    nearest.resize(n.offsets.size());
    EXPECT_EQ(n.offsets, nearest);
  }
}

TEST(NeighbourhoodSample, IsWhatBruteForceFinds) {
  const std::vector<Vec3f> box = sample_box(4000, {1, 1, 1}, 1).positions;
  expect_nearest(box, 24);
  expect_nearest(box, 200);
  std::vector<Vec3f> mixed = box;
  const std::vector<Vec3f> cluster = ball_cluster(4000, 1e-7f, 2);
  mixed.insert(mixed.end(), cluster.begin(), cluster.end());
  std::shuffle(mixed.begin(), mixed.end(), std::mt19937_64(3));
  mixed.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  expect_nearest(mixed, 24);
  expect_nearest(mixed, 200);
  test::expect_equal_for_any_threads([&] {
    std::vector<Vec3f> all;
    for (const Neighbourhood& n : sample_neighbourhoods(mixed, 40, 200))
      all.insert(all.end(), n.offsets.begin(), n.offsets.end());
    return all;
  });
}

TEST(NeighbourhoodSample, ManyTimesTheSamePointIsOnePoint) {
  PointSet points = sample_box(6000, {1, 1, 1}, 1);
  const double spacing = estimate_spacing(points);
  // As in depth cameras: zeros among the samples, more than all other samples.
  PointSet camera;
  for (std::size_t i = 0; i < points.size(); ++i) {
    camera.positions.push_back(points.positions[i]);
    camera.positions.insert(camera.positions.end(), 3, Vec3f{});
  }
  EXPECT_NEAR(estimate_spacing(camera), spacing, 0.1 * spacing);
  const std::vector<Neighbourhood> of_one = sample_neighbourhoods(std::vector<Vec3f>(5000, {1, 2, 3}), 100, 24);
  ASSERT_EQ(of_one.size(), 1u);
  EXPECT_EQ(of_one[0].offsets, (std::vector<Vec3f>{{0, 0, 0}}));
  EXPECT_TRUE(
      sample_neighbourhoods(std::vector<Vec3f>(5000, {1, 2, std::numeric_limits<float>::infinity()}), 9, 9).empty());
}

TEST(NeighbourhoodSample, AFewBallsAroundAllCostLittle) {
  // Squared distances in the cluster are 0, so that most balls have radius zero, and the others contain the cloud.
  std::vector<Vec3f> points = ball_cluster(40, 1, 3);
  for (int i = 0; i < 400; ++i) points.push_back({1e-27f * static_cast<float>(i), 0, 0});
  const std::clock_t before = std::clock();
  const std::vector<Neighbourhood> sample = sample_neighbourhoods(points, 500, 200);
  EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC, 3);
  EXPECT_EQ(sample.size(), points.size());
  for (const Neighbourhood& n : sample) EXPECT_FALSE(n.offsets.empty());
}

}  // namespace
}  // namespace sansmesh::inline v1
