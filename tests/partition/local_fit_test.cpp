#include "sansmesh/partition/fit/local_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "sansmesh/approximation/orthogonal_polynomials.h"

namespace sansmesh::inline v1 {
namespace {

LocalSamples random_samples(std::size_t n, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(-1, 1), weight(0.1f, 1);
  LocalSamples s;
  for (std::size_t i = 0; i < n; ++i) {
    const float u = uniform(generator), v = uniform(generator), w = uniform(generator);
    s.add(u, v, w, weight(generator));
  }
  return s;
}

double value(const std::array<float, 15>& c, double u, double v) {
  double sum = 0;
  std::size_t k = 0;
  for (int d = 0; d <= 4; ++d)
    for (int b = 0; b <= d; ++b) sum += static_cast<double>(c[k++]) * std::pow(u, d - b) * std::pow(v, b);
  return sum;
}

TEST(LocalFit, ReproducesPolynomialsOfItsDegree) {
  for (int degree = 1; degree <= 4; ++degree) {
    LocalSamples s = random_samples(80, 7);
    std::array<float, 15> truth{};
    for (int k = 0; k < kBasisSize[static_cast<std::size_t>(degree)]; ++k)
      truth[static_cast<std::size_t>(k)] = 0.3f * static_cast<float>(k % 5) - 0.5f;
    for (std::size_t i = 0; i < s.size(); ++i) s.w()[i] = static_cast<float>(value(truth, s.u()[i], s.v()[i]));
    const DegreeFits fits = fit_all_degrees(s, 4);
    ASSERT_EQ(fits.highest, 4);
    EXPECT_LT(fits.mean_square[static_cast<std::size_t>(degree)], 1e-12);
    const auto c = monomial_coefficients(fits, degree);
    for (std::size_t k = 0; k < 15; ++k)
      EXPECT_NEAR(c[k], truth[k], 1e-4) << "degree " << degree << " coefficient " << k;
  }
}

TEST(LocalFit, ResidualIsWhatTheCoefficientsLeave) {
  LocalSamples s = random_samples(60, 3);
  const DegreeFits fits = fit_all_degrees(s, 4);
  double last = 1e300;
  for (int d = 0; d <= 4; ++d) {
    const auto c = monomial_coefficients(fits, d);
    double sum = 0, weight = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const double r = s.w()[i] - value(c, s.u()[i], s.v()[i]);
      sum += s.weight()[i] * r * r, weight += s.weight()[i];
    }
    const double reported = fits.mean_square[static_cast<std::size_t>(d)];
    EXPECT_NEAR(reported, sum / weight, 1e-5);
    EXPECT_LE(reported, last);
    last = reported;
  }
}

TEST(LocalFit, IsTheFitByOrthogonalPolynomials) {
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u}) {
    LocalSamples s = random_samples(40 + 30 * seed, seed);
    const DegreeFits fits = fit_all_degrees(s, 4);
    std::array<std::vector<double>, 4> columns;
    for (std::size_t i = 0; i < s.size(); ++i) {
      columns[0].push_back(s.u()[i]), columns[1].push_back(s.v()[i]);
      columns[2].push_back(s.w()[i]), columns[3].push_back(s.weight()[i]);
    }
    ApproximationSamples<2> samples;
    samples.positions = {columns[0], columns[1]};
    samples.values = columns[2];
    samples.weights = columns[3];
    OrthogonalFit<2> oracle;
    oracle.reset(samples, ApproximationFrame<2>{});
    for (int d = 0; d <= fits.highest; ++d) {
      ASSERT_TRUE(oracle.raise());
      const auto k = static_cast<std::size_t>(d);
      EXPECT_NEAR(fits.mean_square[k], oracle.squared_error() / oracle.weight_sum(), 1e-9);
      const auto c = monomial_coefficients(fits, d);
      for (const auto& [u, v] : {std::pair{0.1, -0.7}, {0.9, 0.3}, {-0.5, 0.5}, {0.0, 0.0}})
        EXPECT_NEAR(value(c, u, v), oracle.value({u, v}), 2e-5) << "seed " << seed << " degree " << d;
    }
  }
}

TEST(LocalFit, StopsWhereTheSamplesDetermineNoMore) {
  LocalSamples line;
  for (int i = 0; i < 60; ++i) {
    const float u = static_cast<float>(i) / 30 - 1;
    line.add(u, 0.5f * u, 0.1f, 1);
  }
  EXPECT_EQ(fit_all_degrees(line, 4).highest, 0);  // collinear: no plane
  LocalSamples none, eleven = random_samples(11, 1), twelve = random_samples(12, 1);
  EXPECT_EQ(fit_all_degrees(none, 4).highest, -1);
  EXPECT_EQ(fit_all_degrees(eleven, 4).highest, 1);  // a quadratic needs twice its six unknowns
  EXPECT_EQ(fit_all_degrees(twelve, 4).highest, 2);
}

}  // namespace
}  // namespace sansmesh::inline v1
