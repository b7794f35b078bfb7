// Approximate moving least squares with Laguerre–Gaussians: no system to solve; iterated, it goes over from a smooth
// approximation to the interpolant (METHODS §1.4, §1.5; fasshauer2007).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/approximation/approximate_mls_options.h"
#include "sansmesh/approximation/generating_functions.h"
#include "sansmesh/approximation/sample_index.h"

namespace sansmesh::inline v1 {

/// M f(x) = Σ_j g_j φ_j(x) with g = Σ_{k=0}^{n} (I − A)^k f, A_ij = φ_j(x_i): n iterations, yet each evaluation
/// costs as much as with none. Samples may be in any position; coincident ones act as one with a higher weight.
/// Results do not depend on the number of threads.
template <int D>
class ApproximateMls {
 public:
  /// `values` holds `values.size() / positions.size()` components per sample, sample after sample. Throws ArgumentError
  /// for options out of range and for values that do not fit the positions, DataError for positions or values that are
  /// not finite, for no samples, and where supports are so wide that K has more than `max_entries` entries.
  ApproximateMls(std::span<const Position<D>> positions, std::span<const double> values,
                 const ApproximateMlsOptions& options = {});

  /// Values, components() per point; `gradients`, empty or D per value: ∂/∂x_1 … ∂/∂x_D of component 0, then 1 …. Zero
  /// where no sample is nearer than cutoff_radius(). `gradients` are exact derivatives of the values (of the part
  /// that max(S, 0.55 T) chooses). Throws ArgumentError for spans of other lengths.
  void evaluate(std::span<const Position<D>> x, std::span<double> values, std::span<double> gradients = {}) const;

  /// g, components() per sample.
  std::span<const double> coefficients() const { return coefficients_; }
  /// The root mean square over samples and components of f_i − M f(x_i) after 0, 1, … n iterations; empty for
  /// n = 0, which does not need it.
  std::span<const double> residuals() const { return residuals_; }
  std::size_t components() const { return components_; }
  double spacing() const { return spacing_; }
  double cutoff_radius() const { return radius_; }
  const ApproximateMlsOptions& options() const { return options_; }

 private:
  ApproximateMlsOptions options_;
  SampleIndex<D> index_;
  double spacing_;
  LaguerreGaussian phi_;
  double radius_;
  std::size_t components_ = 1;
  std::vector<double> coefficients_, residuals_;
  std::vector<double> inverse_divisor_;  // of the samples; kSamples only
};

extern template class ApproximateMls<1>;
extern template class ApproximateMls<2>;
extern template class ApproximateMls<3>;

}  // namespace sansmesh::inline v1
