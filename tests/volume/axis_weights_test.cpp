#include "sansmesh/volume/samples/axis_weights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace sansmesh::inline v1::detail {
namespace {

const std::vector<double> kEven{0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4, 4.5};
const std::vector<double> kUneven{0, 0.1, 0.35, 1, 1.2, 2.1, 2.2, 3.4, 3.5, 4};

double value_at(const AxisWeights& w, const std::vector<double>& f) {
  double sum = 0;
  for (std::size_t j = 0; j < w.count; ++j) sum += w.value[j] * f[w.first + j];
  return sum;
}
double slope_at(const AxisWeights& w, const std::vector<double>& f) {
  double sum = 0;
  for (std::size_t j = 0; j < w.count; ++j) sum += w.slope[j] * f[w.first + j];
  return sum;
}

template <class Axis>
void expect_reproduced(const Axis& axis, const std::vector<double>& knots, int degree, double from, double to) {
  for (int d = 0; d <= degree; ++d) {
    std::vector<double> f;
    for (const double k : knots) f.push_back(std::pow(k - 1.3, d));
    for (double x = from; x <= to; x += 0.0371) {
      AxisWeights w;
      axis.weights(x, w);
      ASSERT_LE(w.first + w.count, knots.size());
      ASSERT_NEAR(value_at(w, f), std::pow(x - 1.3, d), 1e-10) << d << ' ' << x;
      ASSERT_NEAR(slope_at(w, f), d == 0 ? 0 : d * std::pow(x - 1.3, d - 1), 1e-9) << d << ' ' << x;
    }
  }
}

template <class Axis>
void expect_slopes_are_derivatives(const Axis& axis, const std::vector<double>& knots, double from, double to) {
  std::vector<double> f;
  for (const double k : knots) f.push_back(std::sin(3 * k));
  for (double x = from; x <= to; x += 0.0571) {
    AxisWeights w, before, after;
    axis.weights(x, w);
    axis.weights(x - 1e-6, before);
    axis.weights(x + 1e-6, after);
    ASSERT_NEAR(slope_at(w, f), (value_at(after, f) - value_at(before, f)) / 2e-6, 1e-6) << x;
  }
}

template <class Axis>
void expect_continuous(const Axis& axis, const std::vector<double>& knots, bool slopes) {
  std::vector<double> f;
  for (const double k : knots) f.push_back(std::sin(7 * k));
  for (const double k : knots) {
    AxisWeights before, after;
    axis.weights(k - 1e-9, before);
    axis.weights(k + 1e-9, after);
    EXPECT_NEAR(value_at(before, f), value_at(after, f), 1e-6) << k;
    if (slopes) EXPECT_NEAR(slope_at(before, f), slope_at(after, f), 1e-5) << k;
  }
}

template <class Axis>
void expect_interpolates(const Axis& axis, const std::vector<double>& knots) {
  for (std::size_t i = 0; i < knots.size(); ++i) {
    AxisWeights w;
    axis.weights(knots[i], w);
    for (std::size_t j = 0; j < w.count; ++j) EXPECT_NEAR(w.value[j], w.first + j == i ? 1 : 0, 1e-12);
  }
}

TEST(CubicAxis, ReproducesParabolasWhereBIsZeroAndCAHalf) {
  expect_reproduced(CubicAxis(kEven, true, 0, 0.5), kEven, 2, 0, 4.5);
  expect_reproduced(CubicAxis(kUneven, false, 0, 0.5), kUneven, 2, 0, 4);
}

TEST(CubicAxis, ReproducesStraightLinesOnTheLineOfMitchellAndNetravali) {
  for (const double b : {0.0, 1.0 / 3, 1.0}) {
    expect_reproduced(CubicAxis(kEven, true, b, (1 - b) / 2), kEven, 1, -0.25, 4.75);
    expect_reproduced(CubicAxis(kUneven, false, b, (1 - b) / 2), kUneven, 1, -0.05, 4.25);
  }
  expect_reproduced(CubicAxis(kEven, true, 0.7, 0.9), kEven, 0, -0.25, 4.75);
}

// The BC kernel of mitchell1988 for |t| < 2 steps.
double bc_kernel(double b, double c, double t) {
  t = std::abs(t);
  if (t < 1) return ((12 - 9 * b - 6 * c) * t * t * t + (-18 + 12 * b + 6 * c) * t * t + 6 - 2 * b) / 6;
  if (t < 2) return ((-b - 6 * c) * t * t * t + (6 * b + 30 * c) * t * t - (12 * b + 48 * c) * t + 8 * b + 24 * c) / 6;
  return 0;
}

TEST(CubicAxis, IsTheKernelOfTheFamilyAwayFromTheEnds) {
  for (const auto& [b, c] : {std::pair{0.0, 0.5}, {1.0, 0.0}, {1.0 / 3, 1.0 / 3}, {0.2, 0.9}}) {
    const CubicAxis even(kEven, true, b, c), plain(kEven, false, b, c);
    for (double x = 1; x < 3.5; x += 0.0371) {
      AxisWeights w, v;
      even.weights(x, w);
      plain.weights(x, v);
      double sum = 0;
      for (std::size_t j = 0; j < 4; ++j) {
        const double kernel = bc_kernel(b, c, (x - kEven[w.first + j]) / 0.5);
        EXPECT_NEAR(w.value[j], kernel, 1e-12) << b << ' ' << c << ' ' << x;
        EXPECT_NEAR(v.value[j], w.value[j], 1e-12);
        sum += w.value[j];
      }
      EXPECT_NEAR(sum, 1, 1e-12);
    }
  }
}

TEST(CubicAxis, IsSmoothAndItsSlopesAreDerivatives) {
  for (const double b : {0.0, 1.0, 0.4}) {
    expect_slopes_are_derivatives(CubicAxis(kUneven, false, b, 0.3), kUneven, -0.2, 4.2);
    expect_continuous(CubicAxis(kEven, true, b, 0.3), kEven, true);
    expect_continuous(CubicAxis(kUneven, false, b, 0.3), kUneven, true);
  }
  expect_interpolates(CubicAxis(kUneven, false, 0, 0.5), kUneven);
}

TEST(CubicAxis, WorksWithTwoKnots) {
  expect_reproduced(CubicAxis(std::vector<double>{0, 2}, true, 0, 0.5), {0, 2}, 1, 0, 2);
  expect_reproduced(CubicAxis(std::vector<double>{0, 2, 3}, false, 0, 0.5), {0, 2, 3}, 2, 0, 3);
  expect_reproduced(CubicAxis(std::vector<double>{0, 2, 3, 7}, false, 0, 0.5), {0, 2, 3, 7}, 2, 0, 7);
}

TEST(SincAxis, InterpolatesAndSumsToOne) {
  const SincAxis axis(kEven);
  expect_interpolates(axis, kEven);
  expect_reproduced(axis, kEven, 0, -0.25, 4.75);
  expect_slopes_are_derivatives(axis, kEven, -0.2, 4.7);
  expect_continuous(axis, kEven, true);
  for (const std::size_t n : {2u, 3u, 5u, 7u}) {
    const std::vector<double> few(kEven.begin(), kEven.begin() + static_cast<std::ptrdiff_t>(n));
    expect_reproduced(SincAxis(few), few, 0, -0.25, few.back() + 0.25);
  }
}

TEST(SincAxis, FollowsWavesAboveTwoSamplesALength) {
  // For waves of five samples linear interpolation has an error of an eighth.
  std::vector<double> knots, f;
  for (int i = 0; i < 40; ++i) knots.push_back(i), f.push_back(std::sin(2 * 3.14159265358979 / 5 * i));
  const SincAxis axis(knots);
  double worst = 0;
  for (double x = 8; x < 32; x += 0.037) {
    AxisWeights w;
    axis.weights(x, w);
    worst = std::max(worst, std::abs(value_at(w, f) - std::sin(2 * 3.14159265358979 / 5 * x)));
  }
  EXPECT_LT(worst, 0.03);
}

TEST(LagrangeAxis, ReproducesPolynomialsOfItsDegree) {
  for (int degree = 1; degree <= 5; ++degree) {
    expect_reproduced(LagrangeAxis(kEven, true, degree), kEven, degree, -0.2, 4.7);
    expect_reproduced(LagrangeAxis(kUneven, false, degree), kUneven, degree, 0, 4);
    expect_interpolates(LagrangeAxis(kUneven, false, degree), kUneven);
    expect_continuous(LagrangeAxis(kUneven, false, degree), kUneven, degree % 2 == 0);
    expect_slopes_are_derivatives(LagrangeAxis(kUneven, false, degree), kUneven, 0.013, 3.97);
  }
  expect_reproduced(LagrangeAxis(std::vector<double>{0, 2, 3}, false, 5), {0, 2, 3}, 2, 0, 3);
}

}  // namespace
}  // namespace sansmesh::inline v1::detail
