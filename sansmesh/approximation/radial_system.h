// Linear system of radial basis functions with a polynomial: its solution and its evaluation.
#pragma once

#include <array>
#include <span>

#include "sansmesh/approximation/generating_functions.h"
#include "sansmesh/approximation/polynomial_order.h"
#include "sansmesh/approximation/sample_index.h"

namespace sansmesh::inline v1::detail {

/// Polynomial of degree <= 2 in u = (x − center) / scale, monomials in PolynomialOrder.
template <int D>
struct PolynomialTail {
  static constexpr int kMaxSize = monomial_count(D, 2);
  int size = 0;
  Position<D> center{};
  double scale = 1;
  std::array<double, kMaxSize> coefficient{};

  /// Values of the first `size` monomials at x.
  void basis(const Position<D>& x, double* values) const;
  /// Adds to value and gradient.
  void add(const Position<D>& x, double& value, Position<D>* gradient) const;
};

/// Number of monomials of a degree >= −1.
template <int D>
int tail_size(int degree) {
  return degree < 0 ? 0 : monomial_count(D, degree);
}

/// Tail in the frame of the samples: centre and half extent.
template <int D>
PolynomialTail<D> make_tail(std::span<const Position<D>> x, int degree);

struct DenseResult {
  int dropped = 0;         ///< monomials that vanish on the samples
  double added_ridge = 0;  ///< increment of λ
};

/// Solves (A + λ) c + P b = f, Pᵀ c = 0 by Cholesky on the null space of Pᵀ. A failing factorisation is repeated with a
/// growing ridge. Writes c and the tail's coefficients.
template <int D>
DenseResult solve_dense(const RadialKernel& kernel, double ridge, std::span<const Position<D>> x,
                        std::span<const double> f, PolynomialTail<D>& tail, std::span<double> c);

struct SparseResult {
  int dropped = 0;
  int iterations = 0;
  double residual = 0;
};

/// The same for a kernel with compact support by conjugate gradients, preconditioned by a sparse approximate inverse of
/// the Cholesky factor. Throws DataError if it does not converge or the support is too wide.
template <int D>
SparseResult solve_sparse(const RadialKernel& kernel, double ridge, const SampleIndex<D>& samples,
                          std::span<const double> f, double tolerance, int max_iterations, PolynomialTail<D>& tail,
                          std::span<double> c);

}  // namespace sansmesh::inline v1::detail
