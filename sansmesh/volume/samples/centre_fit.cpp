#include "sansmesh/volume/samples/centre_fit.h"

#include <algorithm>

namespace sansmesh::inline v1 {
namespace {

// Pivots below this share of their diagonal are undetermined, as in the fits of mls.
constexpr double kLeastCentrePivot = 2e-3;

/// Four sums in a fixed order.
double sum_of_products(const double* a, const double* b, std::size_t n) {
  double sum[4] = {};
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4)
    for (std::size_t k = 0; k < 4; ++k) sum[k] += a[i + k] * b[i + k];
  for (; i < n; ++i) sum[0] += a[i] * b[i];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/// Solves the leading `n` equations of a symmetric system by LDLᵀ; unknowns without a pivot become 0.
template <std::size_t kSize>
void solve_determined(const double (&a)[kSize][kSize], std::size_t n, const double* right, double* x) {
  double l[kSize][kSize], d[kSize], y[kSize];
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      double sum = a[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= l[i][k] * l[j][k] * d[k];
      l[i][j] = d[j] > 0 ? sum / d[j] : 0;
    }
    double pivot = a[i][i];
    for (std::size_t k = 0; k < i; ++k) pivot -= l[i][k] * l[i][k] * d[k];
    d[i] = pivot > kLeastCentrePivot * a[i][i] ? pivot : 0;
    double sum = right[i];
    for (std::size_t k = 0; k < i; ++k) sum -= l[i][k] * y[k];
    y[i] = d[i] > 0 ? sum : 0;
  }
  for (std::size_t i = n; i-- > 0;) {
    x[i] = 0;
    if (!(d[i] > 0)) continue;
    double sum = y[i] / d[i];
    for (std::size_t k = i + 1; k < n; ++k)
      if (d[k] > 0) sum -= l[k][i] * x[k];
    x[i] = sum;
  }
}

std::size_t terms_of(int degree) { return degree == 0 ? 1 : degree == 1 ? 4 : 10; }

}  // namespace

void CentreFit::place(std::span<const Vec3> u) {
  for (auto& b : basis_) b.resize(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double x = u[i].x, y = u[i].y, z = u[i].z;
    const double values[kTerms] = {1, x, y, z, x * x, x * y, x * z, y * y, y * z, z * z};
    for (std::size_t k = 0; k < kTerms; ++k) basis_[k][i] = values[k];
  }
}

void CentreFit::weigh(std::span<const double> weights, int max_degree) {
  const std::size_t n = weights.size();
  weights_.assign(weights.begin(), weights.end());
  weighted_.resize(n);
  const std::size_t terms = terms_of(max_degree);
  for (std::size_t p = 0; p < terms; ++p) {
    for (std::size_t i = 0; i < n; ++i) weighted_[i] = weights_[i] * basis_[p][i];
    for (std::size_t q = p; q < terms; ++q)
      moments_[p][q] = moments_[q][p] = sum_of_products(weighted_.data(), basis_[q].data(), n);
  }
}

std::span<const double> CentreFit::coefficients(int degree) {
  const std::size_t n = weights_.size(), terms = terms_of(degree);
  constexpr double kAtCentre[kTerms] = {1};
  double z[kTerms];
  solve_determined(moments_, terms, kAtCentre, z);
  result_.assign(n, 0.0);
  for (std::size_t p = 0; p < terms; ++p)
    for (std::size_t i = 0; i < n; ++i) result_[i] += z[p] * basis_[p][i];
  for (std::size_t i = 0; i < n; ++i) result_[i] *= weights_[i];
  return result_;
}

Vec3 CentreFit::slope(std::span<const double> f) const {
  const std::size_t n = weights_.size();
  double right[4] = {}, x[4];
  for (std::size_t p = 0; p < 4; ++p)
    for (std::size_t i = 0; i < n; ++i) right[p] += weights_[i] * basis_[p][i] * f[i];
  solve_determined(moments_, 4, right, x);
  return {x[1], x[2], x[3]};
}

}  // namespace sansmesh::inline v1
