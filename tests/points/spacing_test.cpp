#include "sansmesh/points/statistics/spacing.h"

#include <gtest/gtest.h>

#include <numbers>

#include "points/shapes.h"
#include "sansmesh/points/statistics/neighbourhood_sample.h"
#include "sansmesh/search/brute_force.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

double sphere_spacing(std::size_t n) { return std::sqrt(4 * std::numbers::pi / static_cast<double>(n)); }

PointSet grid(int n, float step) {
  PointSet points;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      points.positions.push_back({static_cast<float>(i) * step, static_cast<float>(j) * step, 0});
  return points;
}

TEST(Spacing, IsTheStepOfAGrid) { EXPECT_NEAR(estimate_spacing(grid(100, 0.25f)), 0.25, 0.02); }

TEST(Spacing, IsTheRootOfTheAreaPerSample) {
  for (std::size_t n : {500u, 5000u, 100000u})
    EXPECT_NEAR(estimate_spacing(sample_sphere(n, 1, 0, 1)) / sphere_spacing(n), 1, 0.08) << n;
}

TEST(Spacing, ScalesWithTheCloud) {
  PointSet points = sample_torus(3000, 1, 0.3f, 2);
  const double spacing = estimate_spacing(points);
  for (Vec3f& p : points.positions) p *= 1024;
  EXPECT_DOUBLE_EQ(estimate_spacing(points), 1024 * spacing);
}

TEST(Spacing, IgnoresDuplicates) {
  PointSet points = sample_sphere(4000, 1, 0, 3);
  const double spacing = estimate_spacing(points);
  for (int i = 0; i < 4; ++i) append(points, sample_sphere(4000, 1, 0, 3));
  EXPECT_NEAR(estimate_spacing(points) / spacing, 1, 0.1);
}

TEST(Spacing, SeesThroughNoiseLargerThanItself) {
  const double spacing = sphere_spacing(20000);
  const PointSet points = sample_sphere(20000, 1, static_cast<float>(1.5 * spacing), 4);
  EXPECT_NEAR(estimate_spacing(points) / spacing, 1, 0.2);
}

TEST(Spacing, OfDegenerateClouds) {
  PointSet points;
  EXPECT_EQ(estimate_spacing(points), 0);
  points.positions.assign(50, {1, 2, 3});
  EXPECT_EQ(estimate_spacing(points), 0);
  points.positions.push_back({std::nanf(""), 0, 0});
  EXPECT_EQ(estimate_spacing(points), 0);
  points.positions.push_back({1, 2, 5});
  EXPECT_GT(estimate_spacing(points), 0);
}

TEST(NeighbourhoodSample, HoldsAllSamplesNearItsPlaces) {
  for (std::size_t n : {300u, 20000u, 120000u}) {
    PointSet points = sample_torus(n, 1, 0.4f, 5);
    points.positions[7] = {std::nanf(""), 0, 0};
    const auto sample = sample_neighbourhoods(points.positions, 40, 100);
    ASSERT_EQ(sample.size(), 40u);
    std::size_t complete = 0;
    for (const Neighbourhood& neighbourhood : sample) {
      std::vector<Neighbour> expected(neighbourhood.offsets.size());
      expected.resize(BruteForce(points.positions).nearest(neighbourhood.center, expected));
      ASSERT_EQ(expected.size(), neighbourhood.offsets.size());
      for (std::size_t i = 0; i < expected.size(); ++i)
        ASSERT_FLOAT_EQ(neighbourhood.distances[i], std::sqrt(expected[i].squared_distance));
      complete += neighbourhood.offsets.size() == 100;
    }
    EXPECT_GE(complete, 30u) << n;
  }
}

TEST(NeighbourhoodSample, DoesNotDependOnTheNumberOfThreads) {
  const PointSet points = sample_torus(150000, 1, 0.4f, 6);
  test::compare_threads([&] { return sample_neighbourhoods(points.positions, 60, 80); },
                        [](const auto& one, const auto& many) {
                          ASSERT_EQ(one.size(), many.size());
                          for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one[i].offsets, many[i].offsets);
                        });
}

}  // namespace
}  // namespace sansmesh::inline v1
