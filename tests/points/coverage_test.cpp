#include "sansmesh/points/statistics/coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sansmesh::inline v1 {
namespace {

/// n random samples of the square [0, 1]², except those that `leave_out` rejects.
template <class LeaveOut>
std::vector<Vec3f> square(std::size_t n, const LeaveOut& leave_out) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<Vec3f> samples;
  for (std::size_t i = 0; i < n; ++i)
    if (const Vec3f p{uniform(random), uniform(random), 0}; !leave_out(p)) samples.push_back(p);
  return samples;
}

constexpr auto kNothing = [](const Vec3f&) { return false; };

std::vector<double> values_at(const Coverage& coverage, const std::vector<Vec3>& x) {
  std::vector<double> values(x.size());
  coverage.evaluate(x, values);
  return values;
}

TEST(Coverage, IsWithoutHolesAmongSamplesAtRandom) {
  const std::size_t n = 40000;
  const double spacing = 1 / std::sqrt(static_cast<double>(n));
  const Coverage coverage(square(n, kNothing), spacing);
  std::vector<Vec3> x;
  for (double u = 4 * spacing; u < 1 - 4 * spacing; u += 0.37 * spacing)
    for (double v = 4 * spacing; v < 1 - 4 * spacing; v += 0.37 * spacing) x.push_back({u, v, 0});
  for (const double value : values_at(coverage, x)) ASSERT_LT(value, 0);
}

TEST(Coverage, EndsWithinASpacingOfTheLastSamples) {
  const std::size_t n = 40000;
  const double spacing = 1 / std::sqrt(static_cast<double>(n));
  const Coverage coverage(square(n, kNothing), spacing);
  // Intersections of the contour with lines that leave the square.
  double mean = 0, squares = 0;
  std::size_t count = 0;
  for (double v = 0.05; v < 0.95; v += 0.01) {
    std::vector<Vec3> x;
    for (double u = -3 * spacing; u < 3 * spacing; u += 0.05 * spacing) x.push_back({u, v, 0});
    const std::vector<double> values = values_at(coverage, x);
    EXPECT_GT(values.front(), 0);
    EXPECT_LT(values.back(), 0);
    std::size_t k = 0;
    while (values[k] > 0) ++k;
    const double offset = -x[k].x / spacing;
    mean += offset, squares += offset * offset, ++count;
  }
  mean /= static_cast<double>(count);
  EXPECT_NEAR(mean, 0.5, 0.4);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(count) - mean * mean), 0.5);  // smooth contour
}

TEST(Coverage, ClosesNarrowHolesAndLeavesWideOnes) {
  const std::size_t n = 40000;
  const double spacing = 1 / std::sqrt(static_cast<double>(n));
  for (const double width : {3.0, 20.0}) {
    const auto radius = static_cast<float>(0.5 * width * spacing);
    const auto samples = square(n, [&](const Vec3f& p) { return norm(p - Vec3f{0.5f, 0.5f, 0}) < radius; });
    EXPECT_EQ(values_at(Coverage(samples, spacing), {{0.5, 0.5, 0}})[0] < 0, width < 6) << width;
    EXPECT_LT(values_at(Coverage(samples, spacing, 1.5 * width * spacing), {{0.5, 0.5, 0}})[0], 0) << width;
  }
}

TEST(Coverage, ClosesTheGapsBetweenTheLinesOfAScanner) {
  std::vector<Vec3f> samples;  // points along lines, six times as dense as the lines
  for (int line = 0; line < 60; ++line)
    for (int i = 0; i < 360; ++i) samples.push_back({static_cast<float>(i) / 6, static_cast<float>(line), 0});
  const Coverage coverage(samples, std::sqrt(1.0 / 6));
  std::vector<Vec3> x;
  for (double u = 5; u < 55; u += 0.21)
    for (double v = 5; v < 54; v += 0.23) x.push_back({u, v, 0});
  for (const double value : values_at(coverage, x)) ASSERT_LT(value, 0);
}

TEST(Coverage, RangesHoldTheValues) {
  const Coverage coverage(square(4000, kNothing), 1 / std::sqrt(4000.0));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.3, 1.3);
  std::size_t empty = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 x{uniform(random), uniform(random), uniform(random) - 0.5};
    const Vec3 y = x + Vec3{uniform(random) - 0.5, uniform(random) - 0.5, uniform(random) - 0.5} * 0.2;
    const double radius = norm(y - x);
    ValueRange range{};
    coverage.ranges({&x, 1}, radius, {&range, 1});
    const double value = values_at(coverage, {y})[0];
    EXPECT_TRUE(range.least <= value && value <= range.most);
    empty += range.least > 0;
  }
  EXPECT_GT(empty, 20u);
}

TEST(Coverage, BordersLieAlongTheEdges) {
  const std::size_t n = 40000;
  const double spacing = 1 / std::sqrt(static_cast<double>(n));
  const Coverage coverage(square(n, kNothing), spacing);
  std::size_t at_edges = 0;
  const std::vector<Coverage::Border> borders = coverage.borders();
  for (const Coverage::Border& b : borders) {
    const double edge = std::min({b.position.x, b.position.y, 1 - b.position.x, 1 - b.position.y}) / spacing;
    at_edges += edge < 2.5;
  }
  EXPECT_GT(static_cast<double>(at_edges), 0.9 * static_cast<double>(borders.size()));
  EXPECT_GT(static_cast<double>(at_edges), 0.5 * 4 / spacing);  // at least half of the expected number along the edges
}

}  // namespace
}  // namespace sansmesh::inline v1
