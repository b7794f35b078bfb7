#include "sansmesh/approximation/orthogonal_polynomials.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sansmesh/approximation/orthogonal_kernels.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

// A squared norm below this fraction of the predecessor's has lost digits to cancellation: its row is orthogonalised
// again.
constexpr double kCancellation = 1e-4;

void check_finite(std::span<const double> x, const char* what) {
  double t = 0;
  for (const double v : x) t += v - v;  // 0, or NaN if any value is infinite or NaN
  if (t != 0) throw ArgumentError(std::string("approximation: ") + what + " that are not finite numbers");
}

}  // namespace

template <int D>
OrthogonalFit<D>::OrthogonalFit(OrthogonalFitOptions options) : options_(options) {
  if (!(options.rank_tolerance > 0 && options.rank_tolerance < 1))
    throw ArgumentError("approximation: rank_tolerance must lie in (0, 1)");
}

template <int D>
void OrthogonalFit<D>::reset(const ApproximationSamples<D>& samples,
                             const std::optional<ApproximationFrame<D>>& frame) {
  const std::size_t n = samples.values.size();
  for (const auto& x : samples.positions) {
    if (x.size() != n) throw ArgumentError("approximation: as many positions as values are needed");
    check_finite(x, "positions");
  }
  check_finite(samples.values, "values");
  check_finite(samples.weights, "weights");
  if (!samples.weights.empty()) {
    if (samples.weights.size() != n)
      throw ArgumentError("approximation: as many weights as values are needed, or none");
    if (*std::min_element(samples.weights.begin(), samples.weights.end()) < 0)
      throw ArgumentError("approximation: negative weights");
  }
  if (frame) {
    if (!(frame->scale > 0 && std::isfinite(frame->scale)))
      throw ArgumentError("approximation: the scale must be positive");
    check_finite(frame->center, "centres");
    frame_ = *frame;
  } else {
    frame_ = {};
    double extent = 0;
    for (std::size_t k = 0; n > 0 && k < D; ++k) {
      const auto [low, high] = std::minmax_element(samples.positions[k].begin(), samples.positions[k].end());
      frame_.center[k] = *low + (*high - *low) / 2;
      extent = std::max(extent, (*high - *low) / 2);
    }
    frame_.scale = extent > 0 && std::isnormal(1 / extent) ? extent : 1;
  }

  count_ = n;
  stride_ = (n + detail::kRowLanes - 1) / detail::kRowLanes * detail::kRowLanes;
  size_ = 0;
  dropped_.clear();
  norm_.clear(), inverse_norm_.clear(), coefficient_.clear(), first_.clear(), alpha_.clear(), products_.clear();

  const double factor = 1 / frame_.scale;
  for (std::size_t k = 0; k < D; ++k) {
    u_[k].assign(stride_, 0.0);
    for (std::size_t i = 0; i < n; ++i) u_[k][i] = (samples.positions[k][i] - frame_.center[k]) * factor;
  }
  // Rows contain the square root of the weight, so that inner products are plain dot products.
  rows_.resize(std::max(rows_.size(), stride_));
  residual_.assign(stride_, 0.0);
  std::fill_n(rows_.begin(), stride_, 0.0);
  weight_sum_ = 0;
  squared_error_ = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double w = samples.weights.empty() ? 1.0 : samples.weights[i];
    rows_[i] = std::sqrt(w);
    residual_[i] = rows_[i] * samples.values[i];
    weight_sum_ += w;
    squared_error_ += residual_[i] * residual_[i];
  }
}

template <int D>
bool OrthogonalFit<D>::add_polynomial() {
  const int j = size_;
  if (j >= PolynomialOrder<D>::kSize) return false;
  const auto at = static_cast<std::size_t>(j);
  if (j == 0) {
    const detail::NormAndDot sums = detail::subtract_rows(stride_, nullptr, nullptr, 0, residual_.data(), row(0));
    first_.push_back(0);
    return finish(sums.squared_norm, sums.dot, 0);
  }

  const typename PolynomialOrder<D>::Step& step = order_[j];
  const auto k = static_cast<std::size_t>(step.variable), p = static_cast<std::size_t>(step.predecessor);
  if (rows_.size() < (at + 1) * stride_) rows_.resize((at + 1) * stride_);
  if (products_.size() < order_.slots(j)) products_.resize(order_.slots(j));
  alpha_.resize(row_start(j + 1), 0.0);
  first_.push_back(step.first);
  if (inverse_norm_[p] == 0) {  // u_k · 0
    std::fill_n(row(j), stride_, 0.0);
    return finish(0, 0, 0);
  }

  using Source = typename PolynomialOrder<D>::Source;
  others_.clear();
  for (int l = step.first; l < j; ++l)
    if (step.terms[static_cast<std::size_t>(l - step.first)].source == Source::kComputed) others_.push_back(row(l));
  dots_.resize(at + 1);
  detail::multiply_and_dot(stride_, u_[k].data(), row(step.predecessor), others_.data(), others_.size(), row(j),
                           dots_.data());

  others_.clear();
  double* alpha = alpha_.data() + row_start(j);
  for (std::size_t l = static_cast<std::size_t>(step.first), t = 0, computed = 0; l < at; ++l, ++t) {
    const auto [source, slot] = step.terms[t];
    if (source == Source::kComputed) products_[slot] = dots_[computed++];
    alpha[l] = (source == Source::kNorm ? norm_[p] : products_[slot]) * inverse_norm_[l];
    others_.push_back(row(static_cast<int>(l)));
  }
  const detail::NormAndDot sums =
      detail::subtract_rows(stride_, others_.data(), alpha + step.first, others_.size(), residual_.data(), row(j));
  double norm = sums.squared_norm, dot = sums.dot;
  if (norm < kCancellation * norm_[p] || !dropped_.empty()) orthogonalize_again(j, &norm, &dot);
  return finish(norm, dot, norm_[p]);
}

// Rarely needed: the products that the savings take for zero or known are so only up to rounding, and here only
// rounding remains.
template <int D>
void OrthogonalFit<D>::orthogonalize_again(int j, double* norm, double* dot) {
  const double reference = norm_[static_cast<std::size_t>(order_[j].predecessor)];
  if (!(*norm > options_.rank_tolerance * options_.rank_tolerance * reference)) return;  // about to be dropped
  double* alpha = alpha_.data() + row_start(j);
  for (int l = 0; l < j; ++l) {
    const auto i = static_cast<std::size_t>(l);
    if (inverse_norm_[i] == 0) continue;
    const double* other = row(l);
    const double correction = detail::subtract_rows(stride_, nullptr, nullptr, 0, other, row(j)).dot * inverse_norm_[i];
    const detail::NormAndDot sums = detail::subtract_rows(stride_, &other, &correction, 1, residual_.data(), row(j));
    alpha[i] += correction;
    *norm = sums.squared_norm;
    *dot = sums.dot;
  }
  first_[static_cast<std::size_t>(j)] = 0;
}

template <int D>
bool OrthogonalFit<D>::finish(double norm, double dot, double reference) {
  const int j = size_++;
  const bool keep = norm > options_.rank_tolerance * options_.rank_tolerance * reference && std::isnormal(1 / norm);
  if (!keep) {
    if (norm != 0) std::fill_n(row(j), stride_, 0.0);
    norm_.push_back(0), inverse_norm_.push_back(0), coefficient_.push_back(0);
    dropped_.push_back(j);
    return false;
  }
  const double coefficient = dot / norm;
  norm_.push_back(norm), inverse_norm_.push_back(1 / norm), coefficient_.push_back(coefficient);
  squared_error_ = detail::subtract_from_residual(stride_, row(j), coefficient, residual_.data());
  return true;
}

template <int D>
bool OrthogonalFit<D>::raise() {
  const int next = degree() + 1;
  if (next > kMaxDegree) return false;
  bool any = false;
  while (size_ < monomial_count(D, next)) any = add_polynomial() || any;
  return any;
}

template <int D>
int OrthogonalFit<D>::degree() const {
  int d = -1;
  while (d < kMaxDegree && monomial_count(D, d + 1) <= size_) ++d;
  return d;
}

template <int D>
void OrthogonalFit<D>::basis(const std::array<double, D>& x, std::span<double> values) const {
  std::array<double, D> u;
  for (std::size_t k = 0; k < D; ++k) u[k] = (x[k] - frame_.center[k]) / frame_.scale;
  for (std::size_t j = 0; j < static_cast<std::size_t>(size_); ++j) {
    if (j == 0) {
      values[0] = 1;
      continue;
    }
    const auto& step = order_[static_cast<int>(j)];
    const double* alpha = alpha_.data() + row_start(static_cast<int>(j));
    double t = u[static_cast<std::size_t>(step.variable)] * values[static_cast<std::size_t>(step.predecessor)];
    for (auto l = static_cast<std::size_t>(first_[j]); l < j; ++l) t -= alpha[l] * values[l];
    values[j] = t;
  }
}

template <int D>
double OrthogonalFit<D>::value(const std::array<double, D>& x) const {
  std::array<double, PolynomialOrder<D>::kSize> psi;
  basis(x, psi);
  double result = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(size_); ++j) result += coefficient_[j] * psi[j];
  return result;
}

template <int D>
ValueAndGradient<D> OrthogonalFit<D>::value_and_gradient(const std::array<double, D>& x) const {
  // Slot 0 is the value, slot 1 + k the derivative with respect to u_k.
  std::array<std::array<double, D + 1>, PolynomialOrder<D>::kSize> psi;
  std::array<double, D> u;
  for (std::size_t k = 0; k < D; ++k) u[k] = (x[k] - frame_.center[k]) / frame_.scale;
  std::array<double, D + 1> sum{};
  for (std::size_t j = 0; j < static_cast<std::size_t>(size_); ++j) {
    std::array<double, D + 1>& t = psi[j];
    if (j == 0) {
      t = {1.0};
    } else {
      const auto& step = order_[static_cast<int>(j)];
      const auto k = static_cast<std::size_t>(step.variable);
      const std::array<double, D + 1>& before = psi[static_cast<std::size_t>(step.predecessor)];
      for (std::size_t m = 0; m <= D; ++m) t[m] = u[k] * before[m];
      t[1 + k] += before[0];
      const double* alpha = alpha_.data() + row_start(static_cast<int>(j));
      for (auto l = static_cast<std::size_t>(first_[j]); l < j; ++l)
        for (std::size_t m = 0; m <= D; ++m) t[m] -= alpha[l] * psi[l][m];
    }
    for (std::size_t m = 0; m <= D; ++m) sum[m] += coefficient_[j] * t[m];
  }
  ValueAndGradient<D> result;
  result.value = sum[0];
  for (std::size_t k = 0; k < D; ++k) result.gradient[k] = sum[1 + k] / frame_.scale;
  return result;
}

template <int D>
void OrthogonalFit<D>::monomial_coefficients(std::span<double> coefficients) const {
  monomial_coefficients(coefficient_, coefficients);
}

template <int D>
void OrthogonalFit<D>::monomial_coefficients(std::span<const double> orthogonal, std::span<double> coefficients) const {
  const std::size_t n = orthogonal.size();
  if (n > static_cast<std::size_t>(size_))
    throw ArgumentError("approximation: there must be at most size() polynomials");
  if (coefficients.size() < n)
    throw ArgumentError("approximation: there must be at least size() monomial coefficients");
  std::fill(coefficients.begin(), coefficients.end(), 0.0);
  // Row j holds ψ_j in monomials, entries 0 .. j: a triangle.
  thread_local std::vector<double> rows;
  const auto start = [](std::size_t j) { return j * (j + 1) / 2; };
  rows.assign(start(n), 0.0);
  for (std::size_t j = 0; j < n; ++j) {
    double* own = rows.data() + start(j);
    if (j == 0) {
      own[0] = 1;
    } else {
      const auto& step = order_[static_cast<int>(j)];
      const auto p = static_cast<std::size_t>(step.predecessor);
      const double* before = rows.data() + start(p);
      for (std::size_t m = 0; m <= p; ++m)
        own[static_cast<std::size_t>(order_.product(step.variable, static_cast<int>(m)))] = before[m];
      const double* alpha = alpha_.data() + row_start(static_cast<int>(j));
      for (auto l = static_cast<std::size_t>(first_[j]); l < j; ++l)
        for (std::size_t m = 0; m <= l; ++m) own[m] -= alpha[l] * rows[start(l) + m];
    }
    for (std::size_t m = 0; m <= j; ++m) coefficients[m] += orthogonal[j] * own[m];
  }
}

template class OrthogonalFit<1>;
template class OrthogonalFit<2>;
template class OrthogonalFit<3>;

}  // namespace sansmesh::inline v1
