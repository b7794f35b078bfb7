// Height grids of samples, with and without breaklines.
#include "sansmesh/points/ground/ground_heights.h"
#include "sansmesh/error.h"
#include "sansmesh/points/ground/local_plane.h"
#include "sansmesh/points/ground/sided_plane.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace sansmesh::inline v1 {
namespace {

using Terrain = std::function<double(double, double)>;

constexpr double kSize = 80, kNoiseOfSamples = 0.02;
const Vec3 kOrigin{512000, 5403000, 300};

/// Samples of a square, one per unit of area.
PointSet samples_of(const Terrain& terrain, const std::function<bool(double, double)>& without = nullptr) {
  PointSet points;
  points.origin = kOrigin;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0, kSize);
  std::normal_distribution<double> gauss(0, kNoiseOfSamples);
  for (int i = 0; i < 6400; ++i) {
    const double x = uniform(random), y = uniform(random);
    if (without && without(x, y)) continue;
    points.positions.push_back(Vec3f(Vec3{x, y, terrain(x, y) + gauss(random)}));
  }
  return points;
}

PolylineSet line_of(const std::vector<Vec3>& points) {
  PolylineSet lines;
  lines.origin = kOrigin;
  for (const Vec3& p : points) lines.positions.push_back(Vec3f(p));
  lines.offsets.push_back(lines.positions.size());
  return lines;
}

HeightGrid heights_of(const PointSet& points, const PolylineSet* lines = nullptr) {
  Progress progress;
  return make_ground_heights(points, {.cell = 0.5, .spacing = 1, .gap = 40, .breaklines = lines}, progress).grid;
}

/// Largest and root mean square error of cells whose distance `off` is between 0 and `within`. Unknown heights count as
/// errors of 100.
struct HeightErrors {
  double largest = 0, rms = 0;
};
HeightErrors errors_near(const HeightGrid& grid, const Terrain& terrain, const Terrain& off, double within = 2.5) {
  HeightErrors errors;
  double n = 0;
  for (int r = 0; r < grid.heights.height; ++r)
    for (int c = 0; c < grid.heights.width; ++c) {
      const double x = grid.left + (c + 0.5) * grid.cell - kOrigin.x, y = grid.top - (r + 0.5) * grid.cell - kOrigin.y;
      // The borders have samples on one side only.
      if (std::abs(off(x, y)) > within || std::min({x, y, kSize - x, kSize - y}) < 4) continue;
      const auto h = static_cast<double>(grid.heights.at(c, r));
      const double e = std::isnan(h) ? 100 : std::abs(h - kOrigin.z - terrain(x, y));
      errors.largest = std::max(errors.largest, e), errors.rms += e * e, n += 1;
    }
  errors.rms = std::sqrt(errors.rms / n);
  return errors;
}

/// Distance from the line of the step, which runs askew to the cells.
double off_step(double x, double y) { return (x + 0.3 * y - 52) / std::hypot(1, 0.3); }
double terrace(double x, double y) { return 0.1 * y + (off_step(x, y) >= 0 ? 3 : 0); }
/// The line of the step in this height over its foot.
PolylineSet step_line(double over_foot) {
  return line_of(
      {{52 + 0.3, -1, -0.1 + over_foot}, {52 - 0.3 * 30, 30, 3 + over_foot}, {52 - 0.3 * 81, 81, 8.1 + over_foot}});
}

TEST(GroundHeights, BreaklinesKeepTheStepOfATerrace) {
  const PointSet points = samples_of(terrace);
  const HeightErrors before = errors_near(heights_of(points), terrace, off_step);
  EXPECT_GT(before.largest, 1);
  EXPECT_GT(before.rms, 0.3);
  // At its top, at its foot, in the middle of the wall, or without heights.
  PolylineSet flat = step_line(3);
  for (Vec3f& p : flat.positions) p.z = static_cast<float>(-kOrigin.z);
  for (const PolylineSet& line : {step_line(3), step_line(0), step_line(1.5), flat}) {
    const HeightErrors after = errors_near(heights_of(points, &line), terrace, off_step);
    EXPECT_LT(after.largest, 10 * kNoiseOfSamples);
    EXPECT_LT(after.rms, kNoiseOfSamples);
  }
}

TEST(GroundHeights, BreaklinesKeepTheEdgeOfARidge) {
  const Terrain ridge = [](double x, double y) { return 10 - 0.8 * std::abs(off_step(x, y)); };
  const PointSet points = samples_of(ridge);
  const PolylineSet line = line_of({{52.3, -1, 10}, {52 - 0.3 * 81, 81, 10}});
  const HeightErrors before = errors_near(heights_of(points), ridge, off_step, 0.5),
                     after = errors_near(heights_of(points, &line), ridge, off_step, 0.5);
  EXPECT_GT(before.rms, 0.1);
  EXPECT_LT(after.rms, kNoiseOfSamples);
}

/// Samples around a place, on both sides of a step that is `off` away from it.
std::vector<PlaneValue> values_at_step(double off, double step, double noise) {
  std::vector<PlaneValue> values;
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-2.5, 2.5);
  std::normal_distribution<double> gauss(0, noise);
  while (values.size() < 24) {
    const double x = uniform(random), y = uniform(random);
    if (const double weight = 1 - std::hypot(x, y) / 2.5; weight > 0)
      values.push_back({x, y, 0.2 * y + (x > off ? step : 0) + gauss(random), weight});
  }
  return values;
}

TEST(GroundHeights, PlanesBesideStepsAreOfOneSide) {
  SidedPlanes planes(1);
  std::vector<double> scratch;
  for (const double off : {0.5, 0.8}) {
    const std::vector<PlaneValue> values = values_at_step(off, 3, 0.02);
    EXPECT_GT(planes.deviation(values), 0.3);
    EXPECT_NEAR(planes.height(values, 0.15), 0, 0.05) << off;
    EXPECT_GT(std::abs(fit_local_plane(values, 1, scratch).height), 0.1) << off;
    // A deviation that is usual there is no step.
    EXPECT_EQ(planes.height(values, 3), fit_local_plane(values, 1, scratch).height);
  }
  // Noise and single strays make no sides.
  std::vector<PlaneValue> rough = values_at_step(0, 0, 0.3);
  EXPECT_EQ(planes.height(rough, 0.15), fit_local_plane(rough, 1, scratch).height);
  std::vector<PlaneValue> stray = values_at_step(0, 0, 0.02);
  stray[5].z += 4;
  EXPECT_EQ(planes.height(stray, 0.15), fit_local_plane(stray, 1, scratch).height);
}

// The strip between the two lines of a wall has no samples: its heights are those of its lines.
TEST(GroundHeights, TwoLinesMakeASlope) {
  const auto slope = [](double x, double) { return std::clamp(0.75 * (x - 38), 0.0, 3.0); };
  const PointSet points = samples_of(slope, [](double x, double) { return x > 37.8 && x < 42.2; });
  PolylineSet lines = line_of({{38, -1, 0}, {38, 81, 0}});
  lines.positions.push_back({42, -1, 3}), lines.positions.push_back({42, 81, 3});
  lines.offsets.push_back(4);
  for (Vec3f& p : lines.positions) p.z -= 1;  // not all heights are 0
  PointSet lower = points;
  for (Vec3f& p : lower.positions) p.z -= 1;
  const Terrain expected = [&](double x, double y) { return slope(x, y) - 1; };
  const HeightErrors after = errors_near(heights_of(lower, &lines), expected, [](double x, double) { return x - 40; });
  EXPECT_LT(after.largest, 0.15);
}

/// Whether all heights are known, 3 or more off the border.
bool is_filled(const HeightGrid& grid) {
  for (int r = 6; r + 6 < grid.heights.height; ++r)
    for (int c = 6; c + 6 < grid.heights.width; ++c)
      if (std::isnan(grid.heights.at(c, r))) return false;
  return true;
}

/// Whether the heights are equal in all columns from `first` on.
bool is_equal(const HeightGrid& a, const HeightGrid& b, int first = 0) {
  for (int r = 0; r < a.heights.height; ++r)
    for (int c = first; c < a.heights.width; ++c) {
      const float x = a.heights.at(c, r), y = b.heights.at(c, r);
      if (!(x == y || (std::isnan(x) && std::isnan(y)))) return false;
    }
  return true;
}

/// Largest distance from `expected` of the heights in a square of this half size about (40, 40).
double error_in(const HeightGrid& grid, double half, double expected) {
  double largest = 0;
  for (int r = 0; r < grid.heights.height; ++r)
    for (int c = 0; c < grid.heights.width; ++c) {
      const double x = grid.left + (c + 0.5) * grid.cell - kOrigin.x, y = grid.top - (r + 0.5) * grid.cell - kOrigin.y;
      if (std::max(std::abs(x - 40), std::abs(y - 40)) > half) continue;
      const auto h = static_cast<double>(grid.heights.at(c, r)) - kOrigin.z;
      largest = std::isnan(h) ? 100 : std::max(largest, std::abs(h - expected));
    }
  return largest;
}

// A pit has corners in which a cell sees few samples, and a small one nothing else.
TEST(GroundHeights, ClosedBreaklinesKeepTheirInside) {
  for (const double half : {1.4, 2.1, 3.1, 10.1}) {
    const auto in_pit = [&](double x, double y) { return std::max(std::abs(x - 40), std::abs(y - 40)) < half; };
    const PointSet points = samples_of([&](double x, double y) { return in_pit(x, y) ? -3.0 : 0.0; });
    const double a = 40 - half, b = 40 + half;
    for (const double z : {1e-3, -3.0, -kOrigin.z}) {  // at the top, at the foot, none
      const PolylineSet line = line_of({{a, a, z}, {b, a, z}, {b, b, z}, {a, b, z}, {a, a, z}});
      EXPECT_LT(error_in(heights_of(points, &line), half, -3), 10 * kNoiseOfSamples) << half << " " << z;
    }
  }
}

/// The line with vertices `step` apart.
PolylineSet dense_line(const Vec3& a, const Vec3& b, double step) {
  std::vector<Vec3> all;
  const double count = std::ceil(norm(b - a) / step);
  for (double k = 0; k <= count; ++k) all.push_back(a + (b - a) * (k / count));
  return line_of(all);
}

// A line 0.12 above flat ground is within the tolerance of its samples.
TEST(GroundHeights, DenseBreaklinesCountAsSparseOnes) {
  const Terrain flat = [](double, double) { return 0.5; };
  const PointSet points = samples_of(flat);
  const Vec3 a{40.2, 5, 0.62}, b{40.2, 75, 0.62};
  const PolylineSet sparse = line_of({a, b}), dense = dense_line(a, b, 0.01);
  const HeightErrors of_sparse =
                         errors_near(heights_of(points, &sparse), flat, [](double x, double) { return x - 40; }),
                     of_dense = errors_near(heights_of(points, &dense), flat, [](double x, double) { return x - 40; });
  EXPECT_LT(of_dense.rms, 1.1 * of_sparse.rms);
  EXPECT_LT(of_dense.largest, 1.1 * of_sparse.largest);
  // Neither does a second copy count.
  PolylineSet twice = sparse;
  twice.positions.insert(twice.positions.end(), sparse.positions.begin(), sparse.positions.end());
  twice.offsets.push_back(4);
  EXPECT_TRUE(is_equal(heights_of(points, &twice), heights_of(points, &sparse)));
}

TEST(GroundHeights, RefuseBreaklinesWithoutBound) {
  PolylineSet lines = line_of({{0, 0, 1}});
  for (int k = 0; k < 60'000; ++k)
    lines.positions.push_back({k % 2 == 0 ? 80.0f : 0.0f, 0.001f * static_cast<float>(k), 1});
  lines.offsets = {0, lines.positions.size()};
  EXPECT_THROW(heights_of(samples_of([](double, double) { return 1.0; }), &lines), DataError);
}

// A wall of samples 0.2 wide rises by 25 per unit: a plane through it would be far above it half a cell away.
TEST(GroundHeights, StayNearTheSamples) {
  PointSet points;
  for (int k = 0; k < 80; ++k)
    points.positions.push_back({k % 2 == 0 ? 0.0f : 0.2f, 0.25f * static_cast<float>(k), k % 2 == 0 ? 0.0f : 5.0f});
  Progress progress;
  const HeightGrid grid = make_ground_heights(points, {.cell = 1, .spacing = 1, .gap = 40}, progress).grid;
  std::size_t known = 0;
  for (const float h : grid.heights.pixels) {
    if (std::isnan(h)) continue;
    ++known;
    EXPECT_LT(h, 6);
  }
  EXPECT_GT(known, 10u);
}

TEST(GroundHeights, DistantBreaklinesChangeNothing) {
  const Terrain waves = [](double x, double y) { return std::sin(x / 7) + std::cos(y / 9); };
  // Without a house, whose gap is filled.
  const PointSet points =
      samples_of(waves, [](double x, double y) { return std::abs(x - 40) < 5 && std::abs(y - 30) < 4; });
  const PolylineSet none, outside = line_of({{-500, 0, 1}, {-400, 80, 1}}), west = line_of({{1, 1, 1}, {3, 40, 1}});
  const HeightGrid expected = heights_of(points);
  EXPECT_TRUE(is_filled(expected));
  EXPECT_TRUE(is_equal(heights_of(points, &none), expected));
  EXPECT_TRUE(is_equal(heights_of(points, &outside), expected));
  EXPECT_FALSE(is_equal(heights_of(points, &west), expected));
  EXPECT_TRUE(is_equal(heights_of(points, &west), expected, 20));
  // A closed line around the house has no sample inside: its gap is filled in any case.
  const PolylineSet outline = line_of({{35, 26, 0}, {45, 26, 0}, {45, 34, 0}, {35, 34, 0}, {35, 26, 0}});
  EXPECT_TRUE(is_filled(heights_of(points, &outline)));
}

}  // namespace
}  // namespace sansmesh::inline v1
