#include "sansmesh/volume/samples/mean_fit.h"

#include <algorithm>
#include <cmath>

namespace sansmesh::inline v1 {
namespace {

constexpr double kMostAmplifiedMean = 16, kMostOfMeanPlane = 100;  // as in StencilFit
constexpr double kMeanGain = 0.9, kMostMeanLeverage = 0.98;
constexpr double kOnce = 0.25;
/// Share of a monomial that must remain beside the earlier polynomials.
constexpr double kLeastRemainder = 0.02;

}  // namespace

MeanFit::Means monomials_at(const Vec3& u, int degree) {
  const auto& order = PolynomialOrder<3>::get();
  MeanFit::Means m{1.0};
  const int count = monomial_count(3, degree);
  for (int j = 1; j < count; ++j)
    m[static_cast<std::size_t>(j)] =
        u[static_cast<std::size_t>(order[j].variable)] * m[static_cast<std::size_t>(order[j].predecessor)];
  return m;
}

/// Adds the polynomials of one degree. False if none is determined.
bool MeanFit::raise(int degree, std::span<const Means> means) {
  const std::size_t n = means.size();
  const auto last = static_cast<std::size_t>(monomial_count(3, degree));
  bool any = false;
  for (std::size_t j = polynomials_.size(); j < last; ++j) {
    Means p{};
    p[j] = 1, p[0] = -means[0][j];
    std::vector<double> column(n, 0.0);
    double before = 0;
    for (std::size_t s = 1; s < n; ++s) {
      column[s] = root_[s] * (means[s][j] - means[0][j]);
      before += column[s] * column[s];
    }
    double left = before, norm = 0;
    for (int again = 0; again < 2; ++again) {
      for (std::size_t l = 1; l < j; ++l) {
        if (!(norms_[l] > 0)) continue;
        double product = 0;
        for (std::size_t s = 1; s < n; ++s) product += column[s] * columns_[l][s];
        product /= norms_[l];
        for (std::size_t s = 1; s < n; ++s) column[s] -= product * columns_[l][s];
        for (std::size_t k = 0; k < j; ++k) p[k] -= product * polynomials_[l][k];
      }
      norm = 0;
      for (std::size_t s = 1; s < n; ++s) norm += column[s] * column[s];
      if (norm > kOnce * left) break;  // no cancellation: once is enough
      left = norm;
    }
    const bool determined = norm > kLeastRemainder * kLeastRemainder * before && before > 0;
    any = any || determined;
    polynomials_.push_back(p), columns_.push_back(std::move(column)), norms_.push_back(determined ? norm : 0);
  }
  return any;
}

void MeanFit::fit(std::span<const Means> means, std::span<const double> weights, std::span<const double> f,
                  std::size_t components, std::span<const Means> tests) {
  const std::size_t n = means.size();
  polynomials_.assign(1, {}), columns_.assign(1, {}), norms_.assign(1, 0.0);
  root_.resize(n), leverage_.assign(n, 0.0), amplification_.assign(tests.size(), 0.0);
  std::size_t counted = 0;
  for (std::size_t s = 0; s < n; ++s) root_[s] = std::sqrt(weights[s]), counted += s > 0 && weights[s] > 0;
  residuals_.resize(components * n), coefficients_.assign(components * kTerms, 0.0);
  for (std::size_t m = 0; m < components; ++m)
    for (std::size_t s = 0; s < n; ++s) residuals_[m * n + s] = s > 0 ? root_[s] * f[m * n + s] : 0;
  std::vector<double> sums(components, 0.0);
  const auto score_of = [&](bool first) {
    double score = 0;
    for (std::size_t m = 0; m < components; ++m) {
      double sum = 0;
      for (std::size_t s = 1; s < n; ++s) {
        const double e = residuals_[m * n + s] / (1 - std::min(leverage_[s], kMostMeanLeverage));
        sum += e * e;
      }
      if (first) sums[m] = sum;
      if (sums[m] > 0) score += sum / sums[m];
    }
    return score;
  };
  degree_ = 0;
  double best = score_of(true);
  for (int d = 1; d <= max_degree_ && best > 0; ++d) {
    if (static_cast<double>(counted) + 1 < 1.5 * monomial_count(3, d)) break;
    const std::size_t from = polynomials_.size();
    if (!raise(d, means)) break;
    double worst = 0;
    for (std::size_t t = 0; t < tests.size(); ++t) {
      for (std::size_t j = from; j < polynomials_.size(); ++j) {
        if (!(norms_[j] > 0)) continue;
        double value = 0;
        for (std::size_t k = 0; k <= j; ++k) value += polynomials_[j][k] * tests[t][k];
        amplification_[t] += value * value / norms_[j];
      }
      worst = std::max(worst, amplification_[t]);
    }
    if (worst > (d == 1 ? kMostOfMeanPlane : kMostAmplifiedMean)) break;
    for (std::size_t j = from; j < polynomials_.size(); ++j) {
      if (!(norms_[j] > 0)) continue;
      const std::vector<double>& column = columns_[j];
      const double inverse = 1 / norms_[j];
      for (std::size_t s = 1; s < n; ++s) leverage_[s] += column[s] * column[s] * inverse;
      for (std::size_t m = 0; m < components; ++m) {
        double* r = residuals_.data() + m * n;
        double c = 0;
        for (std::size_t s = 1; s < n; ++s) c += column[s] * r[s];
        c *= inverse;
        coefficients_[m * kTerms + j] = c;
        for (std::size_t s = 1; s < n; ++s) r[s] -= c * column[s];
      }
    }
    const double score = score_of(false);
    if (score < kMeanGain * best) degree_ = d, best = score;
  }
  const auto terms = static_cast<std::size_t>(monomial_count(3, degree_));
  monomials_.assign(components * kTerms, 0.0);
  for (std::size_t m = 0; m < components; ++m)
    for (std::size_t j = 1; j < terms; ++j) {
      const double c = coefficients_[m * kTerms + j];
      if (!(norms_[j] > 0)) continue;
      for (std::size_t k = 0; k <= j; ++k) monomials_[m * kTerms + k] += c * polynomials_[j][k];
    }
}

}  // namespace sansmesh::inline v1
