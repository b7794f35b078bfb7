// Shape and number of iterations of approximate moving least squares, from the data.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/approximation/approximate_mls_options.h"
#include "sansmesh/approximation/sample_index.h"

namespace sansmesh::inline v1 {

struct ApproximateMlsSearch {
  /// Values of ε to try.
  std::vector<double> shapes = {0.35, 0.6, 1.0, 1.7};
  /// Iterations 0 … this are tried.
  int max_iterations = 40;
  /// Samples left out, one at a time.
  std::size_t left_out = 200;
  /// Beyond this many samples eight clusters of about an eighth of it, spread over the cloud, stand for all.
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
/// hardly differs (errors agree with those of a complete recomputation to 1 %). Few iterations come out for noisy
/// values, many for clean ones. `options` gives order, spacing, normalisation and cutoff. Deterministic. Throws as the
/// constructor of ApproximateMls.
template <int D>
ApproximateMlsChoice choose_shape_and_iterations(std::span<const Position<D>> positions, std::span<const double> values,
                                                 const ApproximateMlsOptions& options = {},
                                                 const ApproximateMlsSearch& search = {});

}  // namespace sansmesh::inline v1
