// Robust polynomial fit at one sample from its neighbourhood.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/approximation/orthogonal_polynomials.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct StencilFitOptions {
  int max_degree = 3;  ///< 0..4
  bool robust = true;  ///< samples on the other side of a step have no weight
  /// Weights are exp(−‖u‖² / width²), width in units of the local metric. Larger widths smooth more.
  double width = 1.1;
  bool doubt_own = false;  ///< the sample itself may be an outlier, too
};

/// Weighted least squares in orthogonal polynomials over a stencil, with adaptive degree and robust weights
/// (tejada2008, 3.3, 6.2; docs/methods/volume-reconstruction.md).
/// - The degree increases while there are 1.5 samples per polynomial, the variance Σ ψ_j²/⟨ψ_j, ψ_j⟩ of predictions at
///   the test points stays bounded, and the leave-one-out error falls by a tenth.
/// - At a step between materials only the samples on the side of the sample itself count, unless they are coplanar.
/// - Outliers receive smaller weights, iteratively. The sample itself keeps its weight, unless `doubt_own`.
///
/// One object per thread; it reuses memory.
class StencilFit {
 public:
  explicit StencilFit(const StencilFitOptions& options) : options_(options) {}

  /// u: local coordinates of the samples, the first is the sample itself (0). f: values minus that of the first,
  /// grouped by component, u.size() each. tests: local coordinates of the points where the polynomial is used.
  void fit(std::span<const Vec3> u, std::span<const double> f, std::size_t components, std::span<const Vec3> tests);

  /// Whether the values form two groups as above: a test that is much cheaper than a fit.
  bool has_step(std::span<const double> f, std::size_t n, std::size_t components) {
    own_.assign(n, 1);
    split_ = false;
    find_step(f, n, components, kStep);
    return split_;
  }

  int degree() const { return degree_; }
  /// Coefficients of the monomials in u, the constant first: monomial_count(3, degree()) per component.
  std::span<const double> monomials(std::size_t component) const {
    const auto terms = static_cast<std::size_t>(monomial_count(3, degree_));
    return std::span(monomials_).subspan(component * terms, terms);
  }
  /// The same without the highest degree, if that is 3 or more.
  std::span<const double> lower_monomials(std::size_t component) const {
    const auto terms = static_cast<std::size_t>(monomial_count(3, lower_degree(degree_)));
    return std::span(lower_).subspan(component * terms, terms);
  }
  static int lower_degree(int degree) { return degree > 2 ? degree - 1 : degree; }
  /// Whether a step was found, and whether a sample of the stencil is on the same side of it.
  bool split() const { return split_; }
  bool own_side(std::size_t sample) const { return own_[sample] != 0; }

 private:
  void take(std::span<const Vec3> u, std::span<const double> f, std::size_t components);
  static constexpr double kStep = 3, kTwoValues = 20;  // ratio of the widest gap of values to the next one
  void find_step(std::span<const double> f, std::size_t n, std::size_t components, double ratio);
  bool spans_space();  // whether the samples in use determine slopes in all directions
  void solve(std::size_t components, std::span<const Vec3> tests);
  bool doubt_outliers(std::size_t components, bool first);

  StencilFitOptions options_;
  OrthogonalFit<3> fit_{OrthogonalFitOptions{0.05}};
  int degree_ = 0;
  bool split_ = false;
  double unexplained_ = 0;
  std::vector<unsigned char> own_;
  std::size_t count_ = 0;
  std::array<std::vector<double>, 3> u_;
  std::vector<double> f_, weights_, base_, root_, scale_, residuals_, leverage_, amplification_, psi_, coefficients_,
      monomials_, lower_, sorted_;
};

}  // namespace sansmesh::inline v1
