#include "sansmesh/surface/lop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <numbers>

#include "points/shapes.h"
#include "sansmesh/error.h"
#include "sansmesh/search/kd_tree.h"
#include "support/any_threads.h"
#include "support/sanitizers.h"

namespace sansmesh::inline v1 {
namespace {

PointSet run(const PointSet& points, const LopOptions& options = {}) {
  Progress progress;
  return consolidate(points, options, progress);
}

/// `unevenness` of independent random points on a surface.
const double kRandom = std::sqrt(4 / std::numbers::pi - 1);

/// Standard deviation over mean of the distances to the nearest other point.
double unevenness(const std::vector<Vec3f>& points) {
  const KdTree tree(points);
  double sum = 0, squares = 0;
  for (const Vec3f& p : points) {
    Neighbour found[2];
    tree.nearest(p, found);
    const double squared = static_cast<double>(found[1].squared_distance);
    sum += std::sqrt(squared), squares += squared;
  }
  const double n = static_cast<double>(points.size()), mean = sum / n;
  return std::sqrt(std::max(0.0, squares / n - mean * mean)) / mean;
}

/// Distances to the unit sphere, ascending.
std::vector<double> distances(const PointSet& points) {
  std::vector<double> d;
  for (const Vec3f& p : points.positions) d.push_back(std::abs(norm(Vec3(p)) - 1));
  std::sort(d.begin(), d.end());
  return d;
}

double rms(const std::vector<double>& d) {
  double sum = 0;
  for (const double v : d) sum += v * v;
  return std::sqrt(sum / static_cast<double>(d.size()));
}

TEST(Lop, TakesNoiseAwayAndSpreadsThePoints) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others run the same loops");
  for (const double noise : {0.005, 0.02}) {
    const PointSet sphere = sample_sphere(8000, 1, static_cast<float>(noise), 1);
    for (const bool weighted : {true, false}) {
      LopOptions options;
      options.weighted = weighted;
      const PointSet result = run(sphere, options);
      EXPECT_EQ(result.size(), 4000u);
      EXPECT_LT(rms(distances(result)), noise < 0.01 ? 0.8 * noise : 0.45 * noise) << weighted;
      EXPECT_LT(unevenness(result.positions), (weighted ? 0.75 : 0.95) * unevenness(sphere.positions)) << weighted;
      ASSERT_EQ(result.normals.size(), result.size());
      std::size_t good = 0;
      for (std::size_t i = 0; i < result.size(); ++i)
        good += dot(result.normals[i], normalized(result.positions[i])) > 0.98f;
      EXPECT_GT(good, result.size() * 97 / 100);
    }
  }
}

TEST(Lop, StaysOnCleanSurfaces) {
  const PointSet result = run(sample_sphere(8000, 1, 0, 2));
  EXPECT_LT(distances(result).back(), 0.004);
  EXPECT_LT(unevenness(result.positions), 2.0 / 3 * kRandom);
}

TEST(Lop, EvensOutDensity) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others run the same loops");
  PointSet sphere = sample_sphere(20000, 1, 0.003f, 3), graded;
  for (std::size_t i = 0; i < sphere.size(); ++i)
    if (sphere.normals[i].z > 0 || i % 7 == 0) graded.positions.push_back(sphere.positions[i]);
  const auto upper = [](const PointSet& points) {
    double count = 0;
    for (const Vec3f& p : points.positions) count += p.z > 0;
    return count / static_cast<double>(points.size());
  };
  EXPECT_GT(upper(graded), 0.85);
  LopOptions options;
  options.points = 4000;
  EXPECT_NEAR(upper(run(graded, options)), 0.5, 0.05);
  options.weighted = false;
  EXPECT_GT(upper(run(graded, options)), 0.8);
}

TEST(Lop, OutliersHaveNoPull) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others run the same loops");
  const PointSet clean = sample_sphere(10000, 1, 0.005f, 4);
  PointSet dirty = clean;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> u(-1.5f, 1.5f);
  for (std::size_t i = 0; i < dirty.size(); i += 100) dirty.positions[i] = {u(random), u(random), u(random)};
  const std::vector<double> with = distances(run(dirty)), without = distances(run(clean));
  const std::size_t most = with.size() * 99 / 100;
  EXPECT_LT(with[most], 1.3 * without[most]);
  // Hardly any point stays far out.
  EXPECT_LT(std::count_if(with.begin(), with.end(), [](double d) { return d > 0.03; }), 10);
}

TEST(Lop, TailsOfTheNoiseAreDrawnIn) {
  SANSMESH_NOT_SANITIZED("judges accuracy; others run the same loops");
  // Noise of 1.4 spacings, some of it four times as large.
  PointSet sphere = sample_sphere(8000, 1, 0.04f, 9);
  std::mt19937 random(10);
  std::normal_distribution<float> g(0, 0.16f);
  for (std::size_t i = 0; i < sphere.size(); i += 50) sphere.positions[i] += sphere.normals[i] * g(random);
  const std::vector<double> d = distances(run(sphere));
  EXPECT_LT(d.back(), 0.06);
  EXPECT_LT(rms(d), 0.02);
}

TEST(Lop, IsTheSameForAnyNumberOfThreads) {
  const PointSet sphere = sample_sphere(5000, 1, 0.01f, 6);
  test::compare_threads([&] { return run(sphere); },
                        [](const PointSet& one, const PointSet& many) {
                          EXPECT_EQ(one.positions, many.positions);
                          EXPECT_EQ(one.normals, many.normals);
                        });
}

TEST(Lop, CanGiveMorePointsThanSamples) {
  LopOptions options;
  options.points = 6000;
  const PointSet result = run(sample_sphere(3000, 1, 0, 7), options);
  EXPECT_EQ(result.size(), 6000u);
  EXPECT_LT(distances(result).back(), 0.01);
  EXPECT_LT(unevenness(result.positions), 1.15 * kRandom);  // no worse than random, up to chance
}

TEST(Lop, HeapsOfSamplesCostLittle) {
  // Each sample of the heap has all others as neighbours: 10¹⁰ pairs.
  PointSet sphere = sample_sphere(4000, 1, 0, 1);
  const Vec3f heap = sphere.positions[0];
  for (int i = 0; i < 100000; ++i)
    sphere.positions.push_back(heap + Vec3f{1e-7f * static_cast<float>(i % 5), 1e-7f * static_cast<float>(i % 7), 0});
  LopOptions options;
  options.points = 2000;
  options.normals = false;
  const std::clock_t before = std::clock();
  const PointSet result = run(sphere, options);
  EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC, 15);
  EXPECT_LT(distances(result).back(), 0.02);
  EXPECT_LT(unevenness(result.positions), 0.7 * kRandom);
}

TEST(Lop, SurvivesDegenerateInput) {
  PointSet points;
  EXPECT_THROW(run(points), DataError);
  points.positions.assign(3, {std::numeric_limits<float>::quiet_NaN(), 0, 0});
  EXPECT_THROW(run(points), DataError);
  points.positions = {{1, 2, 3}};
  EXPECT_EQ(run(points).positions, points.positions);
  points.positions.assign(100, {1, 2, 3});
  for (const Vec3f& p : run(points).positions) EXPECT_LT(norm(p - Vec3f{1, 2, 3}), 2);
  points.positions.clear();
  for (int i = 0; i < 500; ++i) points.positions.push_back({static_cast<float>(i), 0, 0});
  points.positions.push_back({0, std::numeric_limits<float>::infinity(), 0});
  const PointSet line = run(points);
  EXPECT_EQ(line.size(), 250u);
  EXPECT_FALSE(line.has_normals());
  for (const Vec3f& p : line.positions) EXPECT_LT(std::abs(p.y) + std::abs(p.z), 2);
}

TEST(Lop, ChecksItsOptions) {
  const PointSet sphere = sample_sphere(100, 1, 0, 8);
  const auto bad = [&](auto change) {
    LopOptions options;
    change(options);
    EXPECT_THROW(run(sphere, options), ArgumentError);
  };
  bad([](LopOptions& o) { o.points = 0; });
  bad([](LopOptions& o) { o.radius = -1; });
  bad([](LopOptions& o) { o.repulsion = 0.5; });
  bad([](LopOptions& o) { o.iterations = 0; });
}

}  // namespace
}  // namespace sansmesh::inline v1
