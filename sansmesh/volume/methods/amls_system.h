// The system that is behind amls: what supports say at the samples.
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

/// φ(t) = w(t) L(t), w = exp(−2 t) (1 − t)⁴, t = r² / R² < 1: about exp(−6 t), cut off smoothly. L makes the order of
/// approximation 2, 4 or 6 (Laguerre–Gaussians).
struct AmlsShape {
  static constexpr double kFall = 2, kDecay = kFall + 4;
  /// Of Σ |φ|: the divisor is no less.
  static constexpr double kLeastShare = 0.55;
  double l0 = 1, l1 = 0, l2 = 0;

  /// order: 2, 4 or 6.
  static AmlsShape of_order(int order);
  /// R of ε: ε r² = 6 t.
  static double radius(double epsilon) { return std::sqrt(kDecay / epsilon); }
  /// 0 from t = 1 on.
  double weight(double t) const {
    const double q = 1 - t, q2 = q * q;
    return t < 1 ? q2 * q2 * std::exp(-kFall * t) : 0;
  }
  double laguerre(double t) const { return l0 + t * (l1 + t * l2); }
  /// Σ w where φ is positive; where it has negative rings, sums of it may vanish.
  double divisor(double sum_of_weights, double sum_of_sizes) const {
    return std::max(sum_of_weights, kLeastShare * sum_of_sizes);
  }
};

/// Σ_{m >= 1} c_m monomial_m(u) of degree 0, 1 or 2, by the number of coefficients: 0, 3 or 9.
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

/// The polynomials with their terms of degree 2 and more multiplied by how far they are trusted.
LocalPolynomials trusted(LocalPolynomials polynomials);

/// Rows of a sparse matrix: A_ij = φ_j(x_i) / D(x_i) of the supports j that hold sample (or place) i.
struct AmlsMatrix {
  std::vector<std::uint64_t> first{0};  ///< where a row begins; one more entry than rows
  std::vector<std::uint32_t> columns;
  std::vector<float> shares;
  std::vector<double> rises;  ///< Σ_j A_ij q_j(x_i): components a row

  std::size_t size() const { return first.size() - 1; }
  /// Σ_j A_ij numbers_j of the rows [begin, end); components a row and a column. In parallel.
  void multiply(std::span<const double> numbers, std::size_t components, std::size_t begin, std::size_t end,
                std::span<double> products) const;
};

/// That of all samples of a volume. `local`: of degree 2 at most, with coefficients as they count.
AmlsMatrix amls_matrix(const SampledVolume& volume, const LocalPolynomials& local, std::span<const float> radii,
                       const AmlsShape& shape);

/// The iteration g = f + Σ_{k < n} (I − A)^k r, r = f − A f − what the local polynomials add, a step at a time. Rows
/// and columns of the matrix are as many as the values.
class AmlsIteration {
 public:
  AmlsIteration(const AmlsMatrix& matrix, std::span<const double> values, std::size_t components);
  /// One more iteration.
  void advance();
  const std::vector<double>& coefficients() const { return g_; }
  /// What the coefficients miss of the values at the samples.
  const std::vector<double>& residuals() const { return residual_; }

 private:
  const AmlsMatrix& matrix_;
  std::size_t components_;
  std::vector<double> g_, residual_, product_;
};

}  // namespace sansmesh::inline v1
