#include "sansmesh/partition/partition_of_unity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "sansmesh/error.h"
#include "sansmesh/partition/fit/partition_fit.h"
#include "support/any_threads.h"
#include "support/clouds.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

PartitionOfUnity fit_cloud(const PointSet& cloud, const PartitionOptions& options = {}) {
  Progress progress;
  return fit_partition_of_unity(cloud, options, progress);
}

double value_at(const ScalarField& field, const Vec3& x) {
  double f = 0;
  field.evaluate(std::span<const Vec3>(&x, 1), std::span<double>(&f, 1));
  return f;
}

std::vector<Vec3> random_directions(std::size_t n) {
  std::mt19937 generator(9);
  std::normal_distribution<double> gauss;
  std::vector<Vec3> d(n);
  for (Vec3& v : d) v = normalized(Vec3{gauss(generator), gauss(generator), gauss(generator)});
  return d;
}

TEST(PartitionOfUnity, IsTheDistanceToASphereNearIt) {
  const PartitionOfUnity field = fit_cloud(test::sphere(20000));
  for (const Vec3& d : random_directions(200))
    for (const double r : {0.99, 1.0, 1.01}) EXPECT_NEAR(value_at(field, d * r), r - 1, 3e-4);
}

TEST(PartitionOfUnity, IsNegativeInsideAndPositiveOutsideEverywhere) {
  const PartitionOfUnity field = fit_cloud(test::sphere(5000));
  for (const Vec3& d : random_directions(300)) {
    for (const double r : {0.0, 0.3, 0.7, 0.9, 0.97}) EXPECT_LT(value_at(field, d * r), 0) << r;
    for (const double r : {1.03, 1.1, 1.5, 3.0, 50.0}) {
      const double f = value_at(field, d * r);
      EXPECT_GT(f, 0) << r;
      EXPECT_TRUE(std::isfinite(f));
    }
  }
}

TEST(PartitionOfUnity, GradientMatchesDifferences) {
  const PartitionOfUnity field = fit_cloud(test::torus(20000));
  std::vector<Vec3> x;
  const PointSet cloud = test::torus(300, 8);
  x.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    x.push_back(Vec3(cloud.positions[i]) + Vec3(cloud.normals[i]) * (0.01 * static_cast<double>(i % 3)));
  std::vector<double> f(x.size());
  std::vector<Vec3> g(x.size());
  field.evaluate(x, f, g);
  const double step = 1e-3;  // float arithmetic inside: smaller steps only show rounding
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 ahead = x[i], behind = x[i];
      ahead[k] += step, behind[k] -= step;
      EXPECT_NEAR(g[i][k], (value_at(field, ahead) - value_at(field, behind)) / (2 * step), 0.01);
    }
}

TEST(PartitionOfUnity, ValuesDoNotDependOnTheBatchOrTheThreads) {
  const PartitionOfUnity field = fit_cloud(test::sphere(5000));
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-1.2, 1.2);
  std::vector<Vec3> x(5000);
  for (Vec3& p : x) p = {uniform(generator), uniform(generator), uniform(generator)};
  std::vector<double> batch(x.size());
  field.evaluate(x, batch);
  test::expect_equal_for_any_threads([&] {
    std::vector<double> values(x.size());
    field.evaluate(x, values);
    return values;
  });
  for (std::size_t i = 0; i < x.size(); i += 50) EXPECT_EQ(value_at(field, x[i]), batch[i]);
}

/// Checks evaluate_signs against evaluate at random points in a cube that is wider than the cloud. Returns the share of
/// points of which only the sign was found.
double check_signs(const PartitionOfUnity& field) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> unit(-1.5, 1.5);
  std::vector<Vec3> x(30000);
  for (Vec3& p : x) p = {unit(generator), unit(generator), unit(generator)};
  std::vector<double> exact(x.size()), found(x.size());
  std::vector<std::uint8_t> sized(x.size(), 2);
  field.evaluate(x, exact);
  field.evaluate_signs(x, found, sized);
  std::size_t wrong = 0, off = 0, signs = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    wrong += (found[i] < 0) != (exact[i] < 0);
    signs += sized[i] == 0;
    off += sized[i] != 0 && std::abs(exact[i]) < 0.01 && std::abs(found[i] - exact[i]) > 0.1 * std::abs(exact[i]);
    EXPECT_LE(sized[i], 1);
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_LE(off, x.size() / 1000);
  return static_cast<double>(signs) / static_cast<double>(x.size());
}

TEST(PartitionOfUnity, SignsAreThoseOfTheValues) {
  PartitionOptions options;
  EXPECT_GT(check_signs(fit_cloud(test::torus(20000), options)), 0.5);
  // A ball with a wide hole, closed by the far field alone; and the same as an open sheet, of which all values are
  // known, roughly where they are large.
  PointSet bowl = test::sphere(20000), kept;
  for (std::size_t i = 0; i < bowl.size(); ++i)
    if (bowl.positions[i].z < 0.5f)
      kept.positions.push_back(bowl.positions[i]), kept.normals.push_back(bowl.normals[i]);
  options.open = false;
  EXPECT_GT(check_signs(fit_cloud(kept, options)), 0.5);
  options.open = true;
  EXPECT_EQ(check_signs(fit_cloud(kept, options)), 0);
}

TEST(PartitionOfUnity, SignsOfOpenThicketsAreThoseOfTheValues) {
  // Noisy ground below overlapping balls with noisy normals, as in scans of vegetation.
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  PointSet cloud;
  for (int i = 0; i < 12000; ++i) {
    const float x = unit(generator), y = unit(generator);
    cloud.positions.push_back({x, y, 0.1f * std::sin(3 * x) + 0.002f * unit(generator)});
    cloud.normals.push_back(normalized(Vec3f{unit(generator), unit(generator), 3}));
  }
  for (int ball = 0; ball < 60; ++ball) {
    const Vec3f center{0.6f * unit(generator), 0.6f * unit(generator), 0.6f + 0.2f * unit(generator)};
    for (int i = 0; i < 200; ++i) {
      const Vec3f up = normalized(Vec3f{unit(generator), unit(generator), unit(generator)});
      cloud.positions.push_back(center + up * 0.12f);
      cloud.normals.push_back(normalized(up + Vec3f{unit(generator), unit(generator), unit(generator)} * 0.3f));
    }
  }
  PartitionOptions options;
  options.open = true;
  const PartitionOfUnity field = fit_cloud(cloud, options);
  std::vector<Vec3> x(20000);
  std::uniform_real_distribution<double> wide(-1.2, 1.2);
  for (Vec3& p : x) p = {wide(generator), wide(generator), wide(generator)};
  std::vector<double> exact(x.size()), found(x.size());
  std::vector<std::uint8_t> sized(x.size());
  field.evaluate(x, exact);
  field.evaluate_signs(x, found, sized);
  std::size_t wrong = 0, rough = 0, off = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    wrong += (found[i] < 0) != (exact[i] < 0);
    rough += found[i] != exact[i];
    EXPECT_EQ(sized[i], 1);
    off += std::abs(exact[i]) < 0.05 && std::abs(found[i] - exact[i]) > 0.2 * std::abs(exact[i]);
  }
  EXPECT_LE(wrong, x.size() / 2000);
  EXPECT_LE(off, x.size() / 1000);
  EXPECT_GT(rough, x.size() / 4);
}

TEST(PartitionOfUnity, LearnsTheNoiseAndAveragesItAway) {
  const double noise = 0.01;
  const PartitionOfUnity field = fit_cloud(test::sphere(40000, noise));
  EXPECT_NEAR(field.report().noise, noise, 0.15 * noise);
  double sum = 0;
  const auto directions = random_directions(500);
  for (const Vec3& d : directions) sum += std::abs(value_at(field, d));
  EXPECT_LT(sum / static_cast<double>(directions.size()), 0.15 * noise);
}

TEST(PartitionOfUnity, KnowsNoiseThatIsLargeAgainstTheSpacing) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others fit noise, too");
  // Small balls cut off the noise beyond them; this must not bias the estimated noise or the scale.
  constexpr std::size_t n = 30000;
  const double spacing = std::sqrt(4 * std::numbers::pi / n);
  for (const double ratio : {0.5, 1.0, 1.5, 2.0}) {
    const double noise = ratio * spacing;
    const PartitionOfUnity field = fit_cloud(test::sphere(n, noise, 5));
    EXPECT_NEAR(field.report().noise, noise, 0.06 * noise) << ratio;
    double squares = 0;
    const auto directions = random_directions(400);
    for (const Vec3& d : directions) squares += std::pow(value_at(field, d), 2);
    EXPECT_LT(std::sqrt(squares / 400), 0.15 * noise) << ratio;
  }
}

/// n samples of the two faces of a plate of this thickness in [-1, 1]², with Gaussian noise across them.
PointSet noisy_plate(std::size_t n, double thickness, double noise) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> gauss(0, noise);
  PointSet cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double side = i % 2 ? 1 : -1;
    cloud.positions.push_back(
        Vec3f(Vec3{uniform(generator), uniform(generator), side * thickness / 2 + gauss(generator)}));
    cloud.normals.push_back(Vec3f(Vec3{0, 0, side}));
  }
  return cloud;
}

/// Root mean square of the function on both faces of that plate, away from its borders.
double plate_error(const PartitionOfUnity& field, double thickness) {
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> uniform(-0.8, 0.8);
  double squares = 0;
  constexpr int kProbes = 1000;
  for (int i = 0; i < kProbes; ++i) {
    const double side = i % 2 ? 1 : -1;
    squares += std::pow(value_at(field, {uniform(generator), uniform(generator), side * thickness / 2}), 2);
  }
  return std::sqrt(squares / kProbes);
}

TEST(PartitionOfUnity, SmoothsThinWallsAlongThemselves) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others fit noise, too");
  // Walls force small blocks even if they are flat, and fixed supports have fits of their own size. A blend of wider
  // fits must be more exact, by far where the wall does not admit larger blocks.
  constexpr std::size_t n = 40000;
  const double spacing = std::sqrt(8.0 / n);
  for (const double sigmas : {4.0, 5.0, 6.0, 8.0}) {
    const double noise = 0.8 * spacing, thickness = sigmas * noise;
    const PointSet cloud = noisy_plate(n, thickness, noise);
    PartitionOptions fixed;
    fixed.support = 1.8;
    const double plain = plate_error(fit_cloud(cloud, fixed), thickness);
    EXPECT_LT(plate_error(fit_cloud(cloud), thickness), (sigmas < 7 ? 0.8 : 1.0) * plain) << sigmas;
  }
}

TEST(PartitionOfUnity, TakesOnlyForNoiseWhatIsEverywhere) {
  const auto scales = [](const PointSet& cloud) { return fit_cloud(cloud).data().basis; };
  const double noise = 0.8 * std::sqrt(4 * std::numbers::pi / 20000);
  const PointSet noisy = test::sphere(20000, noise);
  EXPECT_GT(scales(noisy).support, scales(noisy).fit);
  EXPECT_GT(scales(noisy).height, 3 * noise);
  // The same on three quarters only: the rest may be shape.
  PointSet uneven = noisy;
  for (std::size_t i = 0; i < uneven.size(); ++i)
    if (uneven.normals[i].z > 0.5f) uneven.positions[i] = uneven.normals[i];
  EXPECT_EQ(scales(uneven).support, scales(uneven).fit);
  EXPECT_EQ(scales(test::sphere(20000)).support, 1.5);
}

TEST(PartitionOfUnity, ReproducesCreases) {
  const PointSet cloud = test::cube(20000);
  PartitionOptions smooth;
  smooth.sharp = false;
  const PartitionOfUnity with = fit_cloud(cloud), without = fit_cloud(cloud, smooth);
  EXPECT_GT(with.report().creased, 0u);
  double sharp_error = 0, smooth_error = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 x{1, 1, -0.9 + 0.018 * i};  // along an edge
    sharp_error += std::abs(value_at(with, x));
    smooth_error += std::abs(value_at(without, x));
  }
  EXPECT_LT(sharp_error, 0.1 * smooth_error);
  EXPECT_LT(sharp_error / 100, 1e-3);
}

/// The side of a prism with 24 facets, 15° apart, around z, with |z| < 1.
TEST(PartitionOfUnity, KeepsTheEdgesOfFacets) {
  constexpr int kFacets = 24;
  constexpr double kStep = 2 * std::numbers::pi / kFacets;
  const double half = std::tan(kStep / 2);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> along(-1, 1);
  PointSet cloud;
  for (int i = 0; i < 20000; ++i) {
    const double angle = kStep * (i % kFacets), across = half * along(generator);
    const Vec3 n{std::cos(angle), std::sin(angle), 0}, side{-n.y, n.x, 0};
    cloud.positions.push_back(Vec3f(n + side * across + Vec3{0, 0, 1} * along(generator)));
    cloud.normals.push_back(Vec3f(n));
  }
  std::vector<Vec3> edges;
  for (int i = 0; i < kFacets; ++i)
    for (int k = -8; k <= 8; ++k) {
      const double angle = kStep * (i + 0.5), r = 1 / std::cos(kStep / 2);
      edges.push_back({r * std::cos(angle), r * std::sin(angle), 0.1 * k});
    }
  const auto error = [&](bool sharp) {
    PartitionOptions options;
    options.sharp = sharp;
    std::vector<double> f(edges.size());
    fit_cloud(cloud, options).evaluate(edges, f);
    double squares = 0;
    for (const double v : f) squares += v * v;
    return std::sqrt(squares / static_cast<double>(f.size()));
  };
  EXPECT_LT(error(true), 0.75 * error(false));
}

TEST(PartitionOfUnity, WidensTheSupportsOfExactFunctions) {
  const auto widest = [](const PartitionOfUnity& field) {
    float most = 0;
    for (std::size_t i = 0; i < field.data().supports.size(); ++i) {
      const float block = field.data().edge / static_cast<float>(1u << field.data().supports[i].level);
      most = std::max(most, field.data().functions[i].radius / (0.8660254f * block));
    }
    return most;
  };
  EXPECT_NEAR(widest(fit_cloud(test::cube(8000))), 1.25f * 1.5f, 1e-4f);
  PartitionOptions options;
  options.support = 1.5;
  EXPECT_NEAR(widest(fit_cloud(test::cube(8000), options)), 1.5f, 1e-4f) << "as asked";
}

/// Enough samples for a pilot.
TEST(PartitionOfUnity, APilotKnowsTheNoise) {
  const PartitionOfUnity clean = fit_cloud(test::sphere(200000)), noisy = fit_cloud(test::sphere(200000, 0.005));
  EXPECT_NEAR(clean.data().basis.support, 1.5, 1e-6);
  EXPECT_GT(noisy.data().basis.support, 2);
  EXPECT_NEAR(noisy.report().noise, 0.005, 0.0003);
}

TEST(PartitionOfUnity, SeesNoCreaseOnASmoothSurface) { EXPECT_EQ(fit_cloud(test::torus(20000)).report().creased, 0u); }

TEST(PartitionOfUnity, FitsOnTheDeepestLevelHoweverDenseTheCloud) {
  PartitionOptions options;
  for (const int depth : {2, 3, 4}) {
    options.max_depth = depth;
    const PartitionOfUnity field = fit_cloud(test::sphere(120000), options);
    EXPECT_LE(field.report().depth, depth);
    for (const Vec3& d : random_directions(50)) EXPECT_NEAR(value_at(field, d), 0, 0.05);
  }
}

TEST(PartitionOfUnity, MovesWithTheCloud) {
  PointSet cloud = test::sphere(4000);
  const PartitionOfUnity here = fit_cloud(cloud);
  cloud.origin = {512700.123, 5403800.456, 300.789};
  const PartitionOfUnity there = fit_cloud(cloud);
  for (const Vec3& d : random_directions(50))
    EXPECT_NEAR(value_at(here, d * 1.01), value_at(there, cloud.origin + d * 1.01), 1e-6);
}

TEST(PartitionOfUnity, GradientStaysBoundedInTheDomain) {
  const PartitionOfUnity field = fit_cloud(test::torus(10000));
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-1.4, 1.4);
  std::vector<Vec3> x(20000);
  for (Vec3& p : x) p = {uniform(generator), uniform(generator), 0.35 * uniform(generator)};
  std::vector<double> f(x.size());
  std::vector<Vec3> g(x.size());
  field.evaluate(x, f, g);
  double largest = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (std::abs(f[i]) < 0.05) largest = std::max(largest, norm(g[i]));
  EXPECT_LT(largest, 3);
}

TEST(PartitionOfUnity, RejectsWhatItCannotUse) {
  PointSet few = test::sphere(3);
  EXPECT_THROW(fit_cloud(few), DataError);
  PointSet bare = test::sphere(100);
  bare.normals.clear();
  EXPECT_THROW(fit_cloud(bare), DataError);
  PointSet same = test::sphere(100);
  for (Vec3f& p : same.positions) p = {1, 2, 3};
  EXPECT_THROW(fit_cloud(same), DataError);
  PartitionOptions options;
  options.support = 0.5;
  EXPECT_THROW(fit_cloud(test::sphere(100), options), ArgumentError);
  options = {};
  options.max_degree = 7;
  EXPECT_THROW(fit_cloud(test::sphere(100), options), ArgumentError);
}

}  // namespace
}  // namespace sansmesh::inline v1
