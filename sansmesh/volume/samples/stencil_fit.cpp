#include "sansmesh/volume/samples/stencil_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/median.h"

namespace sansmesh::inline v1 {
namespace {

constexpr auto kTerms = static_cast<std::size_t>(monomial_count(3, 4));
constexpr double kMostAmplified = 16;   // largest variance of predictions, in variances of samples of weight 1
constexpr double kMostOfPlane = 100;    // the same for planes: a constant would be no better
constexpr double kSmooth = 0.01;        // unexplained share of the variance above which a step is possible
constexpr double kGain = 0.9;           // factor by which a degree must improve on the previous one
constexpr double kLeastWeight = 1e-4;   // far samples still help to determine polynomials
constexpr double kMostLeverage = 0.98;  // a sample that determines its own value predicts nothing
// Residuals in units of their median over 0.6745, the deviation of a normal distribution: doubt starts at kOutlier, σ
// is kSensitivity. For clean data all weights stay unchanged, which preserves the order of the fit.
constexpr double kOutlier = 5, kSensitivity = 3;
constexpr double kRounding = 1e-7;  // relative to the largest value: residuals below are rounding
constexpr double kLeastTrust = 1e-6, kSettled = 0.01;
constexpr int kMostRepeats = 10;

}  // namespace

void StencilFit::find_step(std::span<const double> f, std::size_t n, std::size_t components, double ratio) {
  if (n < 12) return;
  for (std::size_t m = 0; m < components; ++m) {
    sorted_.assign(f.begin() + static_cast<std::ptrdiff_t>(m * n),
                   f.begin() + static_cast<std::ptrdiff_t>((m + 1) * n));
    std::sort(sorted_.begin(), sorted_.end());
    double widest = 0, second = 0, middle = 0;
    for (std::size_t i = 1; i < n; ++i) {
      const double gap = sorted_[i] - sorted_[i - 1];
      if (gap > widest) {
        second = widest, widest = gap, middle = 0.5 * (sorted_[i] + sorted_[i - 1]);
      } else {
        second = std::max(second, gap);
      }
    }
    if (!(widest > ratio * second && widest > (sorted_.back() - sorted_.front()) / 3)) continue;
    const bool above = f[m * n] > middle;
    for (std::size_t i = 0; i < n; ++i)
      if ((f[m * n + i] > middle) != above) own_[i] = 0;
    split_ = true;
  }
}

void StencilFit::fit(std::span<const Vec3> u, std::span<const double> f, std::size_t components,
                     std::span<const Vec3> tests) {
  const std::size_t n = u.size();
  own_.assign(n, 1);
  split_ = false;
  take(u, f, components);
  solve(components, tests);
  // Values that a polynomial follows have no steps, however steep they are, unless there are only two values.
  if (options_.robust) {
    const bool smooth = unexplained_ <= kSmooth * static_cast<double>(components);
    find_step(f, n, components, smooth ? kTwoValues : kStep);
    if (split_) take(u, f, components), solve(components, tests);
    // A single layer of samples on this side may also be the end of a slope.
    if (split_ && !spans_space()) {
      own_.assign(n, 1), split_ = false;
      take(u, f, components), solve(components, tests);
    }
    if (!smooth) {
      base_ = weights_;
      scale_.assign(components, std::numeric_limits<double>::infinity());
      for (int again = 0; again < kMostRepeats && doubt_outliers(components, again == 0); ++again)
        solve(components, tests);
    }
  }

  const auto terms = static_cast<std::size_t>(monomial_count(3, degree_));
  monomials_.resize(terms * components);
  for (std::size_t m = 0; m < components; ++m)
    fit_.monomial_coefficients(std::span(coefficients_).subspan(m * kTerms, terms),
                               std::span(monomials_).subspan(m * terms, terms));
  const auto fewer = static_cast<std::size_t>(monomial_count(3, lower_degree(degree_)));
  lower_.resize(fewer * components);
  for (std::size_t m = 0; m < components; ++m)
    fit_.monomial_coefficients(std::span(coefficients_).subspan(m * kTerms, fewer),
                               std::span(lower_).subspan(m * fewer, fewer));
}

bool StencilFit::spans_space() {
  // A constant suffices for equal values.
  if (fit_.size() < monomial_count(3, 1) && !fit_.raise()) return false;
  for (int j = 1; j < monomial_count(3, 1); ++j)
    if (fit_.is_dropped(j)) return false;
  return true;
}

void StencilFit::take(std::span<const Vec3> u, std::span<const double> f, std::size_t components) {
  const std::size_t n = u.size();
  for (auto& axis : u_) axis.clear();
  weights_.clear(), f_.clear();
  for (std::size_t i = 0; i < n; ++i) {
    if (own_[i] == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) u_[k].push_back(u[i][k]);
    weights_.push_back(std::max(std::exp(-squared_norm(u[i]) / (options_.width * options_.width)), kLeastWeight));
  }
  count_ = weights_.size();
  for (std::size_t m = 0; m < components; ++m)
    for (std::size_t i = 0; i < n; ++i)
      if (own_[i] != 0) f_.push_back(f[m * n + i]);
}

void StencilFit::solve(std::size_t components, std::span<const Vec3> tests) {
  const std::size_t n = count_;
  fit_.reset({{u_[0], u_[1], u_[2]}, std::span(f_).first(n), weights_}, ApproximationFrame<3>{});
  leverage_.assign(n, 0.0), amplification_.assign(tests.size(), 0.0);
  coefficients_.assign(components * kTerms, 0.0);
  residuals_.resize(components * n), root_.resize(n);
  for (std::size_t i = 0; i < n; ++i) root_[i] = std::sqrt(weights_[i]);
  for (std::size_t m = 0; m < components; ++m)
    for (std::size_t i = 0; i < n; ++i) residuals_[m * n + i] = root_[i] * f_[m * n + i];
  degree_ = 0;
  double best = 0;
  std::vector<double>& sums = sorted_;
  sums.assign(components, 0.0);
  int counted = 0;
  for (int d = 0; d <= options_.max_degree; ++d) {
    if (d > 0 && static_cast<double>(n) < 1.5 * monomial_count(3, d)) break;
    if (!fit_.raise() && d > 0) break;
    const auto size = static_cast<std::size_t>(fit_.size());
    psi_.resize(size);
    double worst = 0;
    for (std::size_t t = 0; t < tests.size(); ++t) {
      fit_.basis({tests[t].x, tests[t].y, tests[t].z}, psi_);
      for (auto j = static_cast<std::size_t>(counted); j < size; ++j)
        if (!fit_.is_dropped(static_cast<int>(j)))
          amplification_[t] += psi_[j] * psi_[j] / fit_.squared_norm(static_cast<int>(j));
      worst = std::max(worst, amplification_[t]);
    }
    if (d > 0 && worst > (d == 1 ? kMostOfPlane : kMostAmplified)) break;
    for (; counted < fit_.size(); ++counted) {
      if (fit_.is_dropped(counted)) continue;
      const auto row = fit_.weighted_basis(counted);
      const double inverse = 1 / fit_.squared_norm(counted);
      for (std::size_t i = 0; i < n; ++i) leverage_[i] += row[i] * row[i] * inverse;
      for (std::size_t m = 0; m < components; ++m) {
        double* r = residuals_.data() + m * n;
        double c = 0;
        for (std::size_t i = 0; i < n; ++i) c += row[i] * r[i];
        c *= inverse;
        coefficients_[m * kTerms + static_cast<std::size_t>(counted)] = c;
        for (std::size_t i = 0; i < n; ++i) r[i] -= c * row[i];
      }
    }
    double score = 0;
    for (std::size_t m = 0; m < components; ++m) {
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const double e = residuals_[m * n + i] / (1 - std::min(leverage_[i], kMostLeverage));
        sum += e * e;
      }
      if (d == 0) sums[m] = sum;
      if (sums[m] > 0) score += sum / sums[m];
    }
    if (d == 0 || score < kGain * best) degree_ = d, best = score;
    if (score == 0) break;
  }
  unexplained_ = best;
}

bool StencilFit::doubt_outliers(std::size_t components, bool first) {
  const std::size_t n = count_;
  std::vector<double>& e = residuals_;
  bool any = !first;
  for (std::size_t m = 0; m < components; ++m) {
    // Residuals of the chosen degree, without the roots of the weights: far samples may also be on the other side.
    double* r = e.data() + m * n;
    std::copy_n(f_.begin() + static_cast<std::ptrdiff_t>(m * n), n, r);
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, std::abs(r[i]));
    for (int j = 0; j < monomial_count(3, degree_); ++j) {
      const double c = coefficients_[m * kTerms + static_cast<std::size_t>(j)];
      const auto row = fit_.weighted_basis(j);
      for (std::size_t i = 0; i < n; ++i) r[i] -= c * row[i] / root_[i];
    }
    sorted_.resize(n);
    for (std::size_t i = 0; i < n; ++i) sorted_[i] = std::abs(r[i]);
    // Never wider than before: samples on the other side stay there.
    scale_[m] = std::min(scale_[m], std::max(median(sorted_) / 0.6745, kRounding * largest));
    for (std::size_t i = 1; i < n && !any; ++i) any = std::abs(r[i]) > kOutlier * scale_[m];
  }
  if (!any) return false;
  double change = 0;
  for (std::size_t i = options_.doubt_own ? 0 : 1; i < n; ++i) {
    double exponent = 0;
    for (std::size_t m = 0; m < components; ++m) {
      const double sigma = kSensitivity * scale_[m];
      if (sigma > 0) exponent += e[m * n + i] * e[m * n + i] / (2 * sigma * sigma);
    }
    const double weight = base_[i] * std::max(std::exp(-exponent), kLeastTrust);
    change = std::max(change, std::abs(weight - weights_[i]) / base_[i]);
    weights_[i] = weight;
  }
  return change > kSettled;
}

}  // namespace sansmesh::inline v1
