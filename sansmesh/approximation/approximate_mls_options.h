// Options of approximate moving least squares.
#pragma once

#include <cstddef>
#include <optional>

namespace sansmesh::inline v1 {

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
  /// ε, dimensionless. Small: smooth and wide (supports grow with 1/√ε); large: the saturation error, about
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

}  // namespace sansmesh::inline v1
