
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/field/curvature_field.h"
#include "sansmesh/partition/fit/partition_fit.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/formula_field.h"

namespace sansmesh::inline v1 {
namespace {

using test::FormulaField;

const FormulaField kSphere([](const Vec3& p, Vec3& gradient) {
  gradient = normalized(p);
  return norm(p) - 1;
});

/// Torus around z with radii 1 and 0.35.
const FormulaField kTorus([](const Vec3& p, Vec3& gradient) { return test::distance_to_ring(p, gradient) - 0.35; });

std::vector<Vec3> directions(std::size_t n) {
  std::mt19937 random(3);
  std::normal_distribution<double> gauss;
  std::vector<Vec3> result(n);
  for (Vec3& d : result) d = normalized(Vec3{gauss(random), gauss(random), gauss(random)});
  return result;
}

std::vector<LevelSetPoint> points_of(const ScalarField& field, const std::vector<Vec3>& x, double step) {
  std::vector<LevelSetPoint> result(x.size());
  level_set_points(field, x, step, result);
  return result;
}

TEST(LevelSetCurvature, Spheres) {
  for (const double radius : {0.3, 1.0, 1.7}) {  // the level set through x is the sphere through x
    std::vector<Vec3> x = directions(200);
    for (Vec3& p : x) p = p * radius;
    for (const LevelSetPoint& p : points_of(kSphere, x, 1e-3)) {
      ASSERT_NEAR(p.value, radius - 1, 1e-12);
      ASSERT_NEAR(p.k1, 1 / radius, 1e-4);
      ASSERT_NEAR(p.k2, 1 / radius, 1e-4);
      ASSERT_GE(p.k1, p.k2);
    }
  }
}

TEST(LevelSetCurvature, TorusHasBothSigns) {
  std::vector<Vec3> x;
  std::vector<std::array<double, 2>> expected;
  for (int i = 0; i < 60; ++i) {
    const double u = 0.1 + 0.9 * i, v = 0.05 + 0.37 * i, r = 0.2 + 0.005 * i, q = 1 + r * std::cos(v);
    x.push_back({q * std::cos(u), q * std::sin(u), r * std::sin(v)});
    expected.push_back({1 / r, std::cos(v) / q});
  }
  const std::vector<LevelSetPoint> found = points_of(kTorus, x, 1e-3);
  bool saddle = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_NEAR(found[i].k1, std::max(expected[i][0], expected[i][1]), 1e-3);
    ASSERT_NEAR(found[i].k2, std::min(expected[i][0], expected[i][1]), 1e-3);
    ASSERT_NEAR(found[i].mean_curvature(), 0.5 * (expected[i][0] + expected[i][1]), 1e-3);
    ASSERT_NEAR(found[i].gaussian_curvature(), expected[i][0] * expected[i][1], 1e-2);
    saddle = saddle || found[i].gaussian_curvature() < -0.1;
  }
  EXPECT_TRUE(saddle);
}

TEST(LevelSetCurvature, OfTheSetNotOfTheFunction) {
  // A steeper function with the same level sets; the other side of the surface is concave.
  const FormulaField steep([](const Vec3& p, Vec3& gradient) {
    gradient = p * (3 * norm(p));
    return std::pow(norm(p), 3) - 1;
  });
  const FormulaField turned([](const Vec3& p, Vec3& gradient) {
    gradient = -normalized(p);
    return 1 - norm(p);
  });
  const std::vector<Vec3> x = directions(50);
  for (const LevelSetPoint& p : points_of(steep, x, 1e-3)) {
    ASSERT_NEAR(p.k1, 1, 1e-4);
    ASSERT_NEAR(p.k2, 1, 1e-4);
  }
  for (const LevelSetPoint& p : points_of(turned, x, 1e-3)) {
    ASSERT_NEAR(p.k1, -1, 1e-4);
    ASSERT_NEAR(p.k2, -1, 1e-4);
  }
}

TEST(LevelSetCurvature, NoneWhereTheGradientVanishes) {
  const FormulaField flat([](const Vec3& p, Vec3& gradient) {
    gradient = p * 2.0;
    return squared_norm(p);
  });
  const LevelSetPoint p = points_of(flat, {{0, 0, 0}}, 1e-3)[0];
  EXPECT_EQ(p.k1, 0);
  EXPECT_EQ(p.k2, 0);
}

TEST(LevelSetCurvature, OfAFittedSphereAtAQuarterOfTheSpacing) {
  Progress progress;
  const PartitionOfUnity field = fit_partition_of_unity(test::sphere(8000), {}, progress);
  double mean = 0, worst = 0;
  const std::vector<Vec3> x = directions(2000);
  for (const LevelSetPoint& p : points_of(field, x, 0.25 * field.report().spacing)) {
    for (const double k : {p.k1, p.k2}) {
      mean += std::abs(k - 1) / static_cast<double>(2 * x.size());
      worst = std::max(worst, std::abs(k - 1));
    }
  }
  EXPECT_LT(mean, 0.02);
  EXPECT_LT(worst, 0.2);
}

TEST(LevelSetCurvature, ManyPointsAndAnyNumberOfThreads) {
  // More than one batch.
  std::vector<Vec3> x = directions((1 << 17) + 100);
  test::compare_threads([&] { return points_of(kSphere, x, 1e-3); },
                        [&](const auto& one, const auto& many) {
                          for (std::size_t i = 0; i < x.size(); ++i) ASSERT_EQ(one[i].k1, many[i].k1);
                          EXPECT_NEAR(one.back().k2, 1, 1e-4);
                        });
}

TEST(LevelSetCurvature, StepsMustBePositive) {
  for (const double step : {0.0, -1.0, std::nan("")})
    EXPECT_THROW(points_of(kSphere, {{1, 0, 0}}, step), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
