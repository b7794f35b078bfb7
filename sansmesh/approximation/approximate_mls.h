// Approximate moving least squares with Laguerre–Gaussians, without a linear system. Iteration leads from a smooth
// approximation to the interpolant (mazya2001, fasshauer2007).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/approximation/approximate_mls_options.h"
#include "sansmesh/approximation/generating_functions.h"
#include "sansmesh/approximation/sample_index.h"

namespace sansmesh::inline v1 {

/// M f(x) = Σ_j g_j φ_j(x) with g = Σ_{k=0}^{n} (I − A)^k f, A_ij = φ_j(x_i). The cost of an evaluation does not depend
/// on the number n of iterations. Samples may be at any positions; coincident ones act as one with a higher weight.
/// Results do not depend on the number of threads.
template <int D>
class ApproximateMls {
 public:
  /// `values` holds `values.size() / positions.size()` components per sample, sample by sample. Throws ArgumentError
  /// for options out of range and for a number of values that does not fit the positions, DataError for positions or
  /// values that are not finite, for no samples, and if K has more than `max_entries` entries because supports are too
  /// wide.
  ApproximateMls(std::span<const Position<D>> positions, std::span<const double> values,
                 const ApproximateMlsOptions& options = {});

  /// Values, components() per point; `gradients`, empty or D per value: ∂/∂x_1 … ∂/∂x_D of component 0, then 1 …. Zero
  /// farther than the cut-off radius from all samples. `gradients` are exact derivatives of the values (of the branch
  /// that max(S, 0.55 T) selects). Throws ArgumentError for spans of other lengths.
  void evaluate(std::span<const Position<D>> x, std::span<double> values, std::span<double> gradients = {}) const;

  /// g, components() per sample.
  std::span<const double> coefficients() const { return coefficients_; }
  /// Root mean square over samples and components of f_i − M f(x_i) after 0, 1, … n iterations; empty for n = 0.
  std::span<const double> residuals() const { return residuals_; }
  std::size_t components() const { return components_; }
  double spacing() const { return spacing_; }
  const ApproximateMlsOptions& options() const { return options_; }

 private:
  ApproximateMlsOptions options_;
  SampleIndex<D> index_;
  double spacing_;
  LaguerreGaussian phi_;
  double radius_;
  std::size_t components_ = 1;
  std::vector<double> coefficients_, residuals_;
  std::vector<double> inverse_divisor_;  // one per sample; kSamples only
};

extern template class ApproximateMls<1>;
extern template class ApproximateMls<2>;
extern template class ApproximateMls<3>;

}  // namespace sansmesh::inline v1
