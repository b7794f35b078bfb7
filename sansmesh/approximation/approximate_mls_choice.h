// Chooses the shape parameter and the number of iterations of approximate moving least squares from the data.
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
  /// Largest number of iterations to try.
  int max_iterations = 40;
  /// Number of samples left out, one at a time.
  std::size_t left_out = 200;
  /// With more samples than this, eight clusters of about an eighth of it, spread over the cloud, represent the cloud.
  std::size_t max_samples = 20000;
  /// Among choices with an error within this fraction of the least, the one with the fewest iterations is taken.
  double tolerance = 0.02;
};

struct ApproximateMlsChoice {
  double shape = 0;
  int iterations = 0;
  double error = 0;  ///< root mean square error of leaving one sample out, in units of the values
  /// error[shape][iterations] of all trials; infinite where the iteration diverged.
  std::vector<std::vector<double>> errors;
};

/// Chooses ε and the number of iterations by leave-one-out cross validation: the approximation is iterated without
/// sample k and compared with f_k.
/// fasshauer2007 estimates this error from the diagonal of Σ (I − A)^k in place of the inverse of A, which is right
/// only in the limit. Here the iteration without sample k is carried out where φ exceeds 1 % of its peak; farther away
/// the iteration with all samples replaces it (errors agree with those of a complete recomputation to 1 %).
/// Noisy values lead to few iterations, clean ones to many. `options` gives order, spacing, normalisation and cutoff.
/// Deterministic. Throws as the constructor of ApproximateMls.
template <int D>
ApproximateMlsChoice choose_shape_and_iterations(std::span<const Position<D>> positions, std::span<const double> values,
                                                 const ApproximateMlsOptions& options = {},
                                                 const ApproximateMlsSearch& search = {});

}  // namespace sansmesh::inline v1
