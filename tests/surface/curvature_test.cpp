#include "sansmesh/surface/curvature.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "support/any_threads.h"
#include "support/sanitizers.h"
#include "surface/curvature_shapes.h"

namespace sansmesh::inline v1 {
namespace {

using test::Curved;
using test::curved_cloud;
using test::CurvedCloud;
using Weights = CurvatureOptions::Weights;

constexpr Curved kShapes[] = {Curved::sphere, Curved::torus, Curved::ellipsoid};

std::vector<FittedCurvatures> curvatures(const PointSet& points, const CurvatureOptions& options = {}) {
  Progress progress;
  std::vector<FittedCurvatures> found = estimate_curvatures(points, options, progress);
  EXPECT_EQ(found.size(), points.size());
  return found;
}

/// Root mean square error of both curvatures over their root mean square.
double relative_error(const CurvedCloud& truth, const std::vector<FittedCurvatures>& found) {
  double error = 0, size = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double d1 = static_cast<double>(found[i].k1) - truth.k1[i],
                 d2 = static_cast<double>(found[i].k2) - truth.k2[i];
    error += d1 * d1 + d2 * d2;
    size += truth.k1[i] * truth.k1[i] + truth.k2[i] * truth.k2[i];
  }
  return std::sqrt(error / size);
}

TEST(Curvature, OfCleanSamplesIsThatOfTheSurface) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others run the same loops");
  for (const Curved shape : kShapes) {
    const CurvedCloud cloud = curved_cloud(shape, 20000, 0, 1);
    EXPECT_LT(relative_error(cloud, curvatures(cloud.points)), 0.015) << static_cast<int>(shape);
    CurvatureOptions source;
    source.offset = source.refit_normal = false;
    EXPECT_LT(relative_error(cloud, curvatures(cloud.points, source)), 0.015) << static_cast<int>(shape);
  }
}

TEST(Curvature, OfNoisySamplesWithEstimatedNormalsIsClose) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others run the same loops");
  for (const Curved shape : kShapes) {
    CurvedCloud cloud = curved_cloud(shape, 8000, 0.002, 2);
    test::use_estimated_normals(cloud.points);
    EXPECT_LT(relative_error(cloud, curvatures(cloud.points)), 0.05) << static_cast<int>(shape);
    cloud = curved_cloud(shape, 8000, 0.01, 3);
    test::use_estimated_normals(cloud.points);
    EXPECT_LT(relative_error(cloud, curvatures(cloud.points)), 0.1) << static_cast<int>(shape);
  }
}

/// The effect of noise in the heights of the neighbours follows from the weights. With N samples in a disc of radius R
/// = 1.6 h and height errors σ, directional curvatures have the errors 2σ/r². With r² = h² t and weights w, the
/// variance of their mean is 4σ² Σ w²/r⁴ / (Σ w)², those of the two other unknowns are twice as large, and so the
/// relative error of both curvatures together is √5 times the root of it on a unit sphere. For M-like weights w = t²
/// e⁻ᵗ the sums are integrals over t from 0 to 1.6²; for the others, the nearest sample, with r² = R²/N in the mean,
/// dominates the sum of w²/r⁴: their error does not decrease with N.
TEST(Curvature, NeedsWeightsThatDistrustNearSamples) {
  const double noise = 0.002, end = 1.6 * 1.6;
  const CurvedCloud cloud = curved_cloud(Curved::sphere, 20000, noise, 4);
  const CurvedCloud places = curved_cloud(Curved::sphere, 1500, 0, 14);
  const std::vector<Vec3> x(places.points.normals.begin(), places.points.normals.end());
  for (const int neighbours : {60, 120, 240}) {
    const auto error = [&](Weights weights) {
      CurvatureOptions options;
      options.offset = options.refit_normal = false;
      options.neighbours = neighbours;
      options.weights = weights;
      std::vector<FittedCurvatures> found(x.size());
      CurvatureEstimator(cloud.points, options).evaluate(x, x, found);
      return relative_error(places, found);
    };
    const double n = neighbours, radius_squared = 4 * n / 20000;
    // ∫ t² e⁻²ᵗ and ∫ t² e⁻ᵗ from 0 to `end`.
    const double squares = (2 - std::exp(-2 * end) * (4 * end * end + 4 * end + 2)) / 8,
                 sum = 2 - std::exp(-end) * (end * end + 2 * end + 2);
    const double expected =
        std::sqrt(5.0) * 2 * noise / radius_squared * std::sqrt(squares / (sum * sum) * std::pow(end, 3) / n);
    const double m_like = error(Weights::m_like), uniform = error(Weights::uniform),
                 gaussian = error(Weights::gaussian);
    EXPECT_NEAR(m_like, expected, 0.15 * expected) << neighbours;
    EXPECT_GT(uniform, std::sqrt(5.0) * 2 * noise / radius_squared) << neighbours;
    EXPECT_GT(gaussian, uniform) << neighbours;
  }
}

// With neighbourhoods of the size chosen for the noise. In far larger ones the bias grows with the freedom of the fit.
TEST(Curvature, OffsetAndSlopesPayWhereSamplesAndNormalsAreNoisy) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others run the same loops");
  for (const Curved shape : kShapes) {
    CurvedCloud cloud = curved_cloud(shape, 5000, 0.004, 13);
    test::use_estimated_normals(cloud.points);
    const double free = relative_error(cloud, curvatures(cloud.points));
    CurvatureOptions source;
    source.offset = source.refit_normal = false;
    EXPECT_LT(free, 0.6 * relative_error(cloud, curvatures(cloud.points, source)));
  }
}

TEST(Curvature, NeighbourhoodsAreNearTheBestOnes) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others run the same loops");
  for (const Curved shape : {Curved::torus, Curved::ellipsoid})
    for (const double noise : {0.0, 0.002, 0.01}) {
      CurvedCloud cloud = curved_cloud(shape, 4000, noise, 5);
      test::use_estimated_normals(cloud.points);
      const double chosen = relative_error(cloud, curvatures(cloud.points));
      for (const int neighbours : {20, 60, 180, 540}) {
        CurvatureOptions options;
        options.neighbours = neighbours;
        EXPECT_LT(chosen, 1.6 * relative_error(cloud, curvatures(cloud.points, options)) + 0.01) << neighbours;
      }
    }
}

TEST(Curvature, DirectionsAreThoseOfTheSurface) {
  for (const Curved shape : {Curved::torus, Curved::ellipsoid}) {
    CurvedCloud cloud = curved_cloud(shape, 10000, 0.002, 6);
    test::use_estimated_normals(cloud.points);
    const auto found = curvatures(cloud.points);
    std::size_t judged = 0, good = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const FittedCurvatures& c = found[i];
      ASSERT_TRUE(c.defined);
      ASSERT_GE(c.k1, c.k2);
      ASSERT_NEAR(norm(c.direction1), 1, 1e-5);
      ASSERT_NEAR(norm(c.direction2), 1, 1e-5);
      ASSERT_NEAR(dot(c.direction1, c.direction2), 0, 1e-5);
      ASSERT_NEAR(dot(c.direction1, c.normal), 0, 1e-5);
      ASSERT_NEAR(dot(c.direction2, c.normal), 0, 1e-5);
      if (cloud.k1[i] - cloud.k2[i] < 0.5) continue;
      ++judged;
      good += std::abs(dot(Vec3(c.direction1), cloud.direction1[i])) > std::cos(5 * std::numbers::pi / 180);
    }
    EXPECT_GT(judged, 5000u);
    EXPECT_GT(static_cast<double>(good), 0.97 * static_cast<double>(judged));
  }
}

TEST(Curvature, MovesWithTheCloudAndScalesInversely) {
  CurvedCloud cloud = curved_cloud(Curved::ellipsoid, 4000, 0.003, 7);
  const auto before = curvatures(cloud.points);
  // A rotation by 2 asin 0.6 about (2, −1, 2)/3, as a quaternion; then a scale and a translation.
  const Vec3 q = Vec3{2, -1, 2} / 3 * 0.6;
  const double w = 0.8, scale = 7;
  const auto rotate = [&](const Vec3& p) { return p + cross(q, cross(q, p) + p * w) * 2.0; };
  PointSet moved = cloud.points;
  for (Vec3f& p : moved.positions) p = Vec3f(rotate(Vec3(p)) * scale + Vec3{3, 4, 5});
  for (Vec3f& n : moved.normals) n = Vec3f(rotate(Vec3(n)));
  const auto after = curvatures(moved);
  std::size_t same = 0, compared = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    // Rounding may exchange neighbours of equal distance.
    same += std::abs(after[i].k1 * 7 - before[i].k1) < 0.01f && std::abs(after[i].k2 * 7 - before[i].k2) < 0.01f;
    if (before[i].k1 - before[i].k2 < 0.3f) continue;
    ++compared;
    EXPECT_GT(std::abs(dot(rotate(Vec3(before[i].direction1)), Vec3(after[i].direction1))), 0.99);
  }
  EXPECT_GT(same, before.size() * 99 / 100);
  EXPECT_GT(compared, 1000u);
}

TEST(Curvature, TurnsItsSignWithTheNormals) {
  CurvedCloud cloud = curved_cloud(Curved::torus, 4000, 0, 8);
  const auto outward = curvatures(cloud.points);
  for (Vec3f& n : cloud.points.normals) n = -n;
  const auto inward = curvatures(cloud.points);
  for (std::size_t i = 0; i < outward.size(); ++i) {
    EXPECT_NEAR(outward[i].k1, -inward[i].k2, 1e-3f);
    EXPECT_NEAR(outward[i].k2, -inward[i].k1, 1e-3f);
  }
}

TEST(Curvature, IsTheSameForAnyNumberOfThreads) {
  CurvedCloud cloud = curved_cloud(Curved::torus, 10000, 0.005, 9);
  test::compare_threads([&] { return curvatures(cloud.points); },
                        [](const auto& one, const auto& many) {
                          ASSERT_EQ(one.size(), many.size());
                          for (std::size_t i = 0; i < many.size(); ++i)
                            ASSERT_TRUE(many[i].k1 == one[i].k1 && many[i].k2 == one[i].k2);
                        });
}

TEST(Curvature, AnywhereAgreesWithThatAtSamples) {
  const CurvedCloud cloud = curved_cloud(Curved::torus, 20000, 0, 10);
  for (const bool radius : {false, true}) {
    CurvatureOptions options;
    options.neighbours = 30;
    if (radius) options.bandwidth = 0.08;
    const CurvatureEstimator estimator(cloud.points, options);
    Progress progress;
    const auto at_samples = estimator.at_samples(progress);
    std::vector<Vec3> x, normals;
    for (std::size_t i = 0; i < 1000; ++i) {
      x.emplace_back(cloud.points.positions[i]);
      normals.emplace_back(cloud.points.normals[i]);
    }
    std::vector<FittedCurvatures> found(x.size());
    estimator.evaluate(x, normals, found);
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_TRUE(found[i].defined);
      EXPECT_NEAR(found[i].k1, at_samples[i].k1, 2e-3);
      EXPECT_NEAR(found[i].k2, at_samples[i].k2, 2e-3);
    }
    // At points off the surface the offset is the distance, and the curvatures are those of the surface.
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += normals[i] * 0.02;
    estimator.evaluate(x, normals, found);
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_TRUE(found[i].defined);
      EXPECT_NEAR(found[i].offset, -0.02, 1e-3);
      EXPECT_NEAR(found[i].k1, 2.5, 0.2);
    }
    // Far away the curvatures are undefined.
    for (Vec3& p : x) p *= 10.0;
    estimator.evaluate(x, normals, found);
    for (const FittedCurvatures& c : found) EXPECT_FALSE(c.defined);
  }
}

TEST(Curvature, OfCleanSamplesFallsWithTheFourthPowerOfTheSpacing) {
  // Quadrics reduce it by four from one resolution to the next. The noise is estimated, as for files.
  double coarser = 1;
  for (const auto& [m, most] : {std::pair(32, 0.06), std::pair(64, 0.006), std::pair(128, 0.0006)}) {
    CurvedCloud cloud;
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < m / 2; ++j) {
        const double u = 2 * std::numbers::pi * (i + 0.5 * (j % 2)) / m, v = 4 * std::numbers::pi * j / m;
        const double away = 1 + 0.4 * std::cos(v);
        cloud.points.positions.push_back(Vec3f(Vec3{away * std::cos(u), away * std::sin(u), 0.4 * std::sin(v)}));
        cloud.points.normals.push_back(Vec3f(Vec3{std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v)}));
        cloud.k1.push_back(2.5), cloud.k2.push_back(std::cos(v) / away);
      }
    const double error = relative_error(cloud, curvatures(cloud.points));
    EXPECT_LT(error, most) << m;
    EXPECT_LT(error, 0.15 * coarser) << m;
    coarser = error;
  }
}

TEST(Curvature, SeesOneSheetOfAThinPlate) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> u(-1, 1);
  PointSet plate;
  for (int i = 0; i < 5000; ++i) {
    const float side = i % 2 ? 1.0f : -1.0f;
    plate.positions.push_back({u(random), u(random), 0.01f * side});
    plate.normals.push_back({0, 0, side});
  }
  std::size_t defined = 0;
  for (const FittedCurvatures& c : curvatures(plate)) {
    if (!c.defined) continue;
    ++defined;
    EXPECT_LT(curvedness(c), 1e-3f);
  }
  EXPECT_EQ(defined, plate.size());
}

TEST(Curvature, OfDegenerateInputIsUndefined) {
  PointSet points;
  EXPECT_TRUE(curvatures(points).empty());
  points.positions.assign(100, {1, 1, 1});
  points.normals.assign(100, {0, 0, 1});
  for (const FittedCurvatures& c : curvatures(points)) EXPECT_FALSE(c.defined);
  for (std::size_t i = 0; i < 100; ++i) points.positions[i] = {static_cast<float>(i), 0, 0};
  for (const FittedCurvatures& c : curvatures(points)) EXPECT_FALSE(c.defined);
  points.positions.resize(4);
  points.normals.resize(4);
  for (const FittedCurvatures& c : curvatures(points)) EXPECT_FALSE(c.defined);
  CurvedCloud cloud = curved_cloud(Curved::sphere, 2000, 0, 12);
  cloud.points.positions[7].x = std::numeric_limits<float>::quiet_NaN();
  cloud.points.normals[8] = {};
  cloud.points.normals[9].y = std::numeric_limits<float>::infinity();
  const auto found = curvatures(cloud.points);
  ASSERT_EQ(found.size(), 2000u);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].defined, i < 7 || i > 9);
    if (i < 7 || i > 9) {
      EXPECT_NEAR(found[i].k1, 1, 0.02);
    }
  }
}

TEST(Curvature, ChecksItsArguments) {
  PointSet points;
  points.positions.assign(10, {});
  EXPECT_THROW(curvatures(points), DataError);
  points.normals.assign(10, {0, 0, 1});
  const auto bad = [&](auto change) {
    CurvatureOptions options;
    change(options);
    EXPECT_THROW(curvatures(points, options), ArgumentError);
  };
  bad([](CurvatureOptions& o) { o.tau = 0; });
  bad([](CurvatureOptions& o) { o.bandwidth = 0; });
  bad([](CurvatureOptions& o) { o.neighbours = 3; });
  bad([](CurvatureOptions& o) { o.noise = -1; });
  const CurvatureEstimator estimator(points, {});
  std::vector<Vec3> x(2), normals(1);
  std::vector<FittedCurvatures> result(2);
  EXPECT_THROW(estimator.evaluate(x, normals, result), ArgumentError);
}

TEST(Curvature, DerivedMeasures) {
  FittedCurvatures c;
  EXPECT_EQ(shape_index(c), 0);
  c.k1 = 3, c.k2 = 1;
  EXPECT_FLOAT_EQ(mean_curvature(c), 2);
  EXPECT_FLOAT_EQ(gaussian_curvature(c), 3);
  EXPECT_FLOAT_EQ(curvedness(c), std::sqrt(5.0f));
  c.k2 = 3;
  EXPECT_FLOAT_EQ(shape_index(c), 1);
  c.k2 = -3;
  EXPECT_FLOAT_EQ(shape_index(c), 0);
  c.k2 = 0;
  EXPECT_FLOAT_EQ(shape_index(c), 0.5f);
  c.k1 = 0, c.k2 = -2;
  EXPECT_FLOAT_EQ(shape_index(c), -0.5f);
}

}  // namespace
}  // namespace sansmesh::inline v1
