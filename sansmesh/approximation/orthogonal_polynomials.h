// Weighted least squares with polynomials that are orthogonal on the samples: no linear system, and a higher degree
// reuses all results of a lower one (bartels1985, weisfeld1959; tejada2008, ch. 3).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/approximation/polynomial_order.h"

namespace sansmesh::inline v1 {

/// Samples f_i at x_i with weights w_i >= 0 (empty: all 1), as a structure of arrays of equal lengths.
template <int D>
struct ApproximationSamples {
  std::array<std::span<const double>, D> positions;
  std::span<const double> values;
  std::span<const double> weights = {};
};

/// Coordinates of the polynomials: u = (x − center) / scale. Conditioning is best if u covers [−1, 1].
template <int D>
struct ApproximationFrame {
  std::array<double, D> center{};
  double scale = 1;
};

struct OrthogonalFitOptions {
  /// A polynomial is dropped if its norm on the samples is at most this fraction of its predecessor's. Dimensionless,
  /// in (0, 1).
  double rank_tolerance = 1e-6;
};

template <int D>
struct ValueAndGradient {
  double value = 0;
  std::array<double, D> gradient{};
};

/// Least-squares approximation g = Σ c_j ψ_j of samples in D = 1, 2 or 3 variables, extended one polynomial at a time
/// in the order of PolynomialOrder. ψ_0 = 1, ψ_j = u_k ψ_{j'} − Σ_l α_jl ψ_l, orthogonal for ⟨a, b⟩ = Σ_i w_i a(u_i)
/// b(u_i).
///
///     OrthogonalFit<2> fit;
///     fit.reset(samples);
///     while (fit.raise() && fit.squared_error() > limit) {}
///
/// Keep one object per thread and reset() it: its memory is reused, and nothing is allocated after its largest fit.
/// Results are identical bit for bit on every instruction set.
///
/// Samples that do not separate polynomials (on a line, in a plane, too few, coincident) are no error: a polynomial
/// that vanishes on them is dropped with coefficient 0, and so are its successors. The result is the least-squares
/// solution over the remaining polynomials.
template <int D>
class OrthogonalFit {
 public:
  static constexpr int kMaxDegree = PolynomialOrder<D>::kMaxDegree;

  /// Throws ArgumentError for a tolerance out of range.
  explicit OrthogonalFit(OrthogonalFitOptions options = {});

  /// Starts again with no polynomial and a copy of other samples. The default frame is the centre and half the longest
  /// edge of the samples' bounding box. Throws ArgumentError for arrays of different lengths, values that are not
  /// finite, negative weights and a scale that is not positive.
  void reset(const ApproximationSamples<D>& samples, const std::optional<ApproximationFrame<D>>& frame = std::nullopt);

  /// Adds the next polynomial. False: it was dropped, or the highest degree is complete (then size() stays).
  bool add_polynomial();
  /// Adds the polynomials of the next row, which increments degree(). False: all of them were dropped, or the highest
  /// degree is complete. Then no higher degree would add a polynomial either.
  bool raise();

  /// Highest degree whose polynomials are all added; −1 before the first.
  int degree() const;
  /// Number of polynomials added, dropped ones included.
  int size() const { return size_; }
  /// Number of polynomials kept.
  int rank() const { return size_ - static_cast<int>(dropped_.size()); }
  /// Indices of the dropped polynomials, ascending.
  std::span<const int> dropped() const { return dropped_; }
  bool is_dropped(int j) const { return inverse_norm_[static_cast<std::size_t>(j)] == 0; }

  /// c_j, j < size().
  double coefficient(int j) const { return coefficient_[static_cast<std::size_t>(j)]; }
  /// ⟨ψ_j, ψ_j⟩; 0 if dropped.
  double squared_norm(int j) const { return norm_[static_cast<std::size_t>(j)]; }
  /// α_jl, l < j < size(); exactly 0 below the first polynomial that polynomial j is orthogonalised against.
  double alpha(int j, int l) const { return alpha_[row_start(j) + static_cast<std::size_t>(l)]; }

  /// √w_i (f_i − g(x_i)), in the order of the samples.
  std::span<const double> weighted_residuals() const { return {residual_.data(), count_}; }
  /// √w_i ψ_j(x_i), in the order of the samples; 0 if dropped.
  std::span<const double> weighted_basis(int j) const {
    return {rows_.data() + static_cast<std::size_t>(j) * stride_, count_};
  }
  /// Σ w_i (f_i − g(x_i))².
  double squared_error() const { return squared_error_; }
  double weight_sum() const { return weight_sum_; }
  const ApproximationFrame<D>& frame() const { return frame_; }

  /// g(x), by the recurrence. 0 before the first polynomial.
  double value(const std::array<double, D>& x) const;
  /// g(x) and its gradient with respect to x.
  ValueAndGradient<D> value_and_gradient(const std::array<double, D>& x) const;
  /// ψ_j(x) for j < size(); dropped ones are (nearly) 0 on the samples. `values` has size() entries.
  void basis(const std::array<double, D>& x, std::span<double> values) const;

  /// Coefficients of g as a polynomial in u: g(x) = Σ_j a_j monomial_j((x − center) / scale), exponents in
  /// PolynomialOrder. Writes the first size() entries of `coefficients` and sets the rest to 0; throws ArgumentError if
  /// it is shorter.
  void monomial_coefficients(std::span<double> coefficients) const;
  /// The same for Σ_j orthogonal[j] ψ_j, with as many terms as `orthogonal` has, at most size().
  void monomial_coefficients(std::span<const double> orthogonal, std::span<double> coefficients) const;

 private:
  static std::size_t row_start(int j) { return static_cast<std::size_t>(j) * static_cast<std::size_t>(j - 1) / 2; }
  double* row(int j) { return rows_.data() + static_cast<std::size_t>(j) * stride_; }
  bool finish(double norm, double dot, double reference);
  void orthogonalize_again(int j, double* norm, double* dot);

  const PolynomialOrder<D>& order_ = PolynomialOrder<D>::get();
  OrthogonalFitOptions options_;
  ApproximationFrame<D> frame_;
  std::size_t count_ = 0;
  std::size_t stride_ = 0;  // number of samples, rounded up to whole SIMD lanes; the padding is 0
  std::array<std::vector<double>, D> u_;
  std::vector<double> rows_;  // √w_i ψ_j(u_i), row j
  std::vector<double> residual_;
  double squared_error_ = 0;
  double weight_sum_ = 0;

  int size_ = 0;
  std::vector<int> dropped_;
  std::vector<double> norm_, inverse_norm_, coefficient_;
  std::vector<int> first_;
  std::vector<double> alpha_;     // triangle: row j has j entries
  std::vector<double> products_;  // inner products by slot of PolynomialOrder
  std::vector<const double*> others_;
  std::vector<double> dots_;
};

extern template class OrthogonalFit<1>;
extern template class OrthogonalFit<2>;
extern template class OrthogonalFit<3>;

}  // namespace sansmesh::inline v1
