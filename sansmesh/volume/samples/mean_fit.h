// Polynomial fit to means over cells: the mean over the own cell is the own value exactly.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/approximation/polynomial_order.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Weighted least squares over the cells of a stencil, in polynomials that are orthogonal under the sum over cells of
/// products of means and have the mean 0 over the own cell (barth1990: k-exact reconstruction). The degree increases as
/// in StencilFit. One object per thread; it reuses memory.
class MeanFit {
 public:
  static constexpr auto kTerms = static_cast<std::size_t>(monomial_count(3, 4));
  /// Means of the monomials over a cell, in the order of PolynomialOrder<3>.
  using Means = std::array<double, kTerms>;

  explicit MeanFit(int max_degree) : max_degree_(max_degree) {}

  /// means: of the own cell first, then of the others. weights: 0 excludes a cell. f: values minus the own value,
  /// grouped by component, means.size() each. tests: monomials at the points where the polynomial is used.
  void fit(std::span<const Means> means, std::span<const double> weights, std::span<const double> f,
           std::size_t components, std::span<const Means> tests);

  int degree() const { return degree_; }
  /// Coefficients of the monomials, the constant first (relative to the own value): monomial_count(3, degree()).
  std::span<const double> monomials(std::size_t component) const {
    const auto terms = static_cast<std::size_t>(monomial_count(3, degree_));
    return std::span(monomials_).subspan(component * kTerms, terms);
  }

 private:
  bool raise(int degree, std::span<const Means> means);

  int max_degree_, degree_ = 0;
  // Orthogonal polynomials: coefficients of monomials, √weight times means over cells, squared norms (0: dropped).
  std::vector<Means> polynomials_;
  std::vector<std::vector<double>> columns_;
  std::vector<double> norms_;
  std::vector<double> root_, residuals_, leverage_, amplification_, monomials_, coefficients_;
};

/// Values of the monomials at u, up to a degree; 0 above.
MeanFit::Means monomials_at(const Vec3& u, int degree);

}  // namespace sansmesh::inline v1
