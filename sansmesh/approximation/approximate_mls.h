// Approximate moving least squares with Laguerre–Gaussians: no system to solve; iterated, it goes over from a smooth
// approximation to the interpolant (METHODS §1.4, §1.5; fasshauer2007).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/approximation/generating_functions.h"
#include "sansmesh/approximation/sample_index.h"

namespace sansmesh {

/// What the generating functions φ_j are divided by. The divisor is max(S, 0.55 T), where S sums the Gaussians (the
/// φ_j of order 2) and T the |φ_j|. On regular samples that is S = 1. It has no zeros, unlike the sum of the φ_j of
/// higher order, and is never so small that the iteration diverges.
enum class Normalisation {
  kNone,      ///< nothing: exact on regular samples away from the boundary; may diverge where samples are dense
  kSamples,   ///< every φ_j by the sums over the samples x_i (irregular spacing); the iteration tends to the RBF
              ///< interpolant of the φ_j whatever the samples
  kPartition  ///< by the sums over j at the point x: a partition of unity for order 2, where constants are exact up to
              ///< the boundary; the iteration converges too, to an interpolant of the divided functions
};

struct ApproximateMlsOptions {
  /// Approximation order 2, 4 or 6 (d = 0, 1, 2) on regular samples. On irregular ones 2 with some iterations is the
  /// better choice: functions of higher order have negative rings, which gaps between samples turn into errors.
  int order = 2;
  /// ε, without unit. Small: smooth and wide (supports grow with 1/√ε); large: the saturation error, about
  /// exp(−π²/ε) of the values (times a factor that grows with the order), shows between samples.
  double shape = 1;
  /// h, a length > 0. Unset: SampleIndex::spacing().
  std::optional<double> spacing = {};
  /// n >= 0: number of times that the approximation of the residual is added.
  int iterations = 4;
  Normalisation normalisation = Normalisation::kPartition;
  /// |φ| below this fraction of its peak is taken for zero, in (0, 0.1].
  double cutoff = 1e-5;
  /// Non-zero entries of K allowed (12 bytes each); more throws DataError.
  std::size_t max_entries = std::size_t{1} << 30;
};

/// M f(x) = Σ_j g_j φ_j(x) with g = Σ_{k=0}^{n} (I − A)^k f, A_ij = φ_j(x_i): n iterations at the price of none in
/// every evaluation. Samples may be in any position; coincident ones act as one with a higher weight.
/// Results do not depend on the number of threads.
template <int D>
class ApproximateMls {
 public:
  /// `values` holds `values.size() / positions.size()` components a sample, sample after sample. Throws ArgumentError
  /// for options out of range and for values that do not fit the positions, DataError for positions or values that are
  /// not finite, for no samples, and where supports are so wide that K has more than `max_entries` entries.
  ApproximateMls(std::span<const Position<D>> positions, std::span<const double> values,
                 const ApproximateMlsOptions& options = {});

  /// Values, components() a point; `gradients`, empty or D a value: ∂/∂x_1 … ∂/∂x_D of component 0, then 1 …. Zero
  /// where no sample is nearer than cutoff_radius(). `gradients` are exact derivatives of the values (of the part
  /// that max(S, 0.55 T) chooses). Throws ArgumentError for spans of other lengths.
  void evaluate(std::span<const Position<D>> x, std::span<double> values, std::span<double> gradients = {}) const;

  /// g, components() a sample.
  std::span<const double> coefficients() const { return coefficients_; }
  /// The root mean square over samples and components of f_i − M f(x_i) after 0, 1, … n iterations; empty for
  /// n = 0, which has no use for it.
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

struct ApproximateMlsSearch {
  /// Values of ε to try.
  std::vector<double> shapes = {0.35, 0.6, 1.0, 1.7};
  /// Iterations 0 … this are tried.
  int max_iterations = 40;
  /// Samples left out, one at a time.
  std::size_t left_out = 200;
  /// Beyond this many samples eight clumps of about an eighth of it, spread over the cloud, stand for the rest.
  std::size_t max_samples = 20000;
  /// Of all choices whose error is within this fraction of the least, the one with the fewest iterations is taken.
  double tolerance = 0.02;
};

struct ApproximateMlsChoice {
  double shape = 0;
  int iterations = 0;
  double error = 0;  ///< root mean square error of leaving one sample out, in units of the values
  /// error[shape][iterations] of all that was tried; infinite where the iteration diverged.
  std::vector<std::vector<double>> errors;
};

/// ε and the number of iterations by leave-one-out cross validation: sample k is left out, the approximation iterated
/// without it and compared with f_k. Not an estimate by the diagonal of a matrix (fasshauer2007 takes Σ (I − A)^k for
/// the inverse of A there, which is right only in the limit): the iteration without sample k is carried out, but only
/// as far from it as φ exceeds 1 % of its peak; further away the iteration with all samples is taken, from which it
/// hardly differs (errors agree with those of computing all anew to about 1 %). Few iterations come out for noisy
/// values, many for clean ones. `options` gives order, spacing, normalisation and cutoff. Deterministic. Throws as the
/// constructor of ApproximateMls.
template <int D>
ApproximateMlsChoice choose_shape_and_iterations(std::span<const Position<D>> positions, std::span<const double> values,
                                                 const ApproximateMlsOptions& options = {},
                                                 const ApproximateMlsSearch& search = {});

extern template class ApproximateMls<1>;
extern template class ApproximateMls<2>;
extern template class ApproximateMls<3>;

}  // namespace sansmesh
