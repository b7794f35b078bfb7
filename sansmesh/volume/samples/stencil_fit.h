// The polynomial about one sample from those around it.
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
  bool robust = true;  ///< samples on the other side of a step do not count
  /// Weights are exp(−‖u‖² / width²), width in units of the local metric. Wider ones smooth.
  double width = 1.1;
};

/// Weighted least squares in orthogonal polynomials over a stencil (METHODS §1.3, §6.1), of the degree that predicts
/// best: the degree is raised as long as
/// - there are 1.5 samples a polynomial,
/// - a unit of noise at the samples stays below four at all places where the polynomial is going to be used (the
///   variance of predictions, Σ ψ_j²/⟨ψ_j, ψ_j⟩: what samples do not determine is large there),
/// - and the mean square of errors of leaving a sample out (weighted; e_i / (1 − h_ii), no fit anew) falls by a tenth.
/// Where more than a hundredth of the variance stays unexplained and the values fall into two groups with a gap between
/// them that is three times as wide as any other and a third of their range (or, whatever is explained, twenty times as
/// wide), a step between materials, only the group of the sample itself counts (robust), unless this lies in a plane:
/// nothing tells then whether values rise across it. Then, if a residual exceeds
/// five deviations (the median of all over 0.6745), weights become w_i ψ'(e_i²) = w_i exp(−e_i² / (2 σ²)), w_i those of
/// distance and e_i the residuals f_i − p(u_i) of the fit before, of all components; σ is three deviations, of the fit
/// where they were least. Polynomials are made orthogonal anew and fitted, until no weight changes by more than a
/// hundredth of w_i, ten times at most. The sample itself keeps its weight.
///
/// One object a thread; its memory is reused.
class StencilFit {
 public:
  explicit StencilFit(const StencilFitOptions& options) : options_(options) {}

  /// u: local coordinates of the samples, the first is the one that the polynomial is about (0). f: values less that of
  /// the first, component after component, u.size() each. tests: local coordinates of where the polynomial is used.
  void fit(std::span<const Vec3> u, std::span<const double> f, std::size_t components, std::span<const Vec3> tests);

  /// Whether the values fall into two groups as above: a test that costs much less than a fit.
  bool has_step(std::span<const double> f, std::size_t n, std::size_t components) {
    own_.assign(n, 1);
    split_ = false;
    find_step(f, n, components, kStep);
    return split_;
  }

  int degree() const { return degree_; }
  /// Coefficients of the monomials in u, of the constant first: monomial_count(3, degree()) a component.
  std::span<const double> monomials(std::size_t component) const {
    const auto terms = static_cast<std::size_t>(monomial_count(3, degree_));
    return std::span(monomials_).subspan(component * terms, terms);
  }
  /// Whether a step was found, and whether a sample of the stencil is on the own side of it.
  bool split() const { return split_; }
  bool own_side(std::size_t sample) const { return own_[sample] != 0; }

 private:
  void take(std::span<const Vec3> u, std::span<const double> f, std::size_t components);
  static constexpr double kStep = 3, kTwoValues = 20;  // of the widest gap of values to the next
  void find_step(std::span<const double> f, std::size_t n, std::size_t components, double ratio);
  bool spans_space();  // whether the samples taken tell of slopes in all directions
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
