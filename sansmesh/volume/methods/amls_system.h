// Linear system of amls: the supports evaluated at the samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/samples/local_polynomials.h"
#include "sansmesh/volume/samples/monomial_table.h"

namespace sansmesh::inline v1 {

/// φ(t) = w(t) L(t), w = exp(−2 t) (1 − t)⁴, t = r² / R² < 1: about exp(−6 t) with a smooth cut-off. L sets the order
/// of approximation to 2, 4 or 6 (Laguerre–Gaussians).
struct AmlsShape {
  static constexpr double kFall = 2, kDecay = kFall + 4;
  /// Lower bound of the divisor, relative to Σ |φ|.
  static constexpr double kLeastShare = 0.55;
  double l0 = 1, l1 = 0, l2 = 0;

  /// order: 2, 4 or 6.
  static AmlsShape of_order(int order);
  /// Radius R for ε: ε r² = 6 t.
  static double radius(double epsilon) { return std::sqrt(kDecay / epsilon); }
  /// 0 for t >= 1.
  double weight(double t) const {
    const double q = 1 - t, q2 = q * q;
    return t < 1 ? q2 * q2 * std::exp(-kFall * t) : 0;
  }
  double laguerre(double t) const { return l0 + t * (l1 + t * l2); }
  /// Σ w where φ is positive; where φ has negative rings, sums of φ may vanish.
  double divisor(double sum_of_weights, double sum_of_sizes) const {
    return std::max(sum_of_weights, kLeastShare * sum_of_sizes);
  }
};

/// Σ_{m >= 1} c_m monomial_m(u) of degree 0, 1 or 2 for 0, 3 or 9 coefficients.
inline double amls_rise(std::span<const float> c, const Vec3& u) {
  double sum = 0;
  if (c.size() >= 3)
    for (std::size_t k = 0; k < 3; ++k) sum += static_cast<double>(c[k]) * u[k];
  if (c.size() >= 9)
    for (std::size_t j = 4; j < 10; ++j) {
      constexpr const detail::MonomialTable& t = detail::kMonomials;
      sum += static_cast<double>(c[j - 1]) * u[t.variable[j]] * u[t.predecessor[j] - 1u];
    }
  return sum;
}

/// Multiplies the terms of degree 2 and more by the trust of the polynomials.
LocalPolynomials trusted(LocalPolynomials polynomials);

/// Sparse matrix in rows: A_ij = φ_j(x_i) / D(x_i) of the supports j that contain sample (or point) i.
struct AmlsMatrix {
  std::vector<std::uint64_t> first{0};  ///< begin of each row; one more entry than rows
  std::vector<std::uint32_t> columns;
  std::vector<float> shares;
  std::vector<double> rises;  ///< Σ_j A_ij q_j(x_i): all components of a row

  std::size_t size() const { return first.size() - 1; }
  /// Σ_j A_ij numbers_j of the rows [begin, end), with all components of a row and a column. Runs in parallel.
  void multiply(std::span<const double> numbers, std::size_t components, std::size_t begin, std::size_t end,
                std::span<double> products) const;
};

/// The matrix of all samples of a volume. `local`: degree 2 at most, with final coefficients.
AmlsMatrix amls_matrix(const SampledVolume& volume, const LocalPolynomials& local, std::span<const float> radii,
                       const AmlsShape& shape);

/// The iteration g = f + Σ_{k < n} (I − A)^k r, r = f − A f − (contribution of the local polynomials), one step at a
/// time. The matrix has as many rows and columns as there are values.
class AmlsIteration {
 public:
  AmlsIteration(const AmlsMatrix& matrix, std::span<const double> values, std::size_t components);
  /// Adds one iteration.
  void advance();
  const std::vector<double>& coefficients() const { return g_; }
  /// Residuals of the values at the samples.
  const std::vector<double>& residuals() const { return residual_; }

 private:
  const AmlsMatrix& matrix_;
  std::size_t components_;
  std::vector<double> g_, residual_, product_;
};

}  // namespace sansmesh::inline v1
