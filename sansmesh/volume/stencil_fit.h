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
};

/// Weighted least squares in orthogonal polynomials over a stencil (tejada2008, 3.3, 6.2), of the degree that predicts
/// best: the degree increases as long as
/// - there are 1.5 samples per polynomial,
/// - unit noise at the samples stays below four at all points where the polynomial is used (variance of predictions,
///   Σ ψ_j²/⟨ψ_j, ψ_j⟩: it is large in undetermined directions),
/// - and the mean squared leave-one-out error (weighted; e_i / (1 − h_ii), without refits) falls by a tenth.
/// A step between materials is detected where more than a hundredth of the variance stays unexplained and the values
/// form two groups with a gap that is three times as wide as any other and a third of their range (or, for any
/// variance, twenty times as wide). Then only the group of the sample itself counts (robust), unless it is planar: it
/// would not determine slopes across its plane. Afterwards, if a residual exceeds five deviations (the median of all
/// over 0.6745), weights become w_i ψ'(e_i²) = w_i exp(−e_i² / (2 σ²)), w_i the distance weights and e_i the residuals
/// f_i − p(u_i) of the previous fit over all components; σ is three deviations of the fit where they were smallest.
/// Orthogonalisation and fit are repeated until no weight changes by more than a hundredth of w_i, at most ten times.
/// The sample itself keeps its weight.
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
      monomials_, sorted_;
};

}  // namespace sansmesh::inline v1
