// Options of approximate moving least squares.
#pragma once

#include <cstddef>
#include <optional>

namespace sansmesh::inline v1 {

/// Divisor of the generating functions φ_j: max(S, 0.55 T), where S sums the Gaussians (the φ_j of order 2) and T the
/// |φ_j|. On regular samples it is S = 1. It has no zeros, unlike the sum of the φ_j of higher order, and is large
/// enough for the iteration to converge.
enum class Normalisation {
  kNone,  ///< no division: exact on regular samples away from the boundary; may diverge where samples are dense
  /// Each φ_j by the sums over the samples x_i (irregular spacing). The iteration tends to the RBF interpolant of the
  /// φ_j for any samples.
  kSamples,
  /// By the sums over j at the point x: a partition of unity for order 2, which reproduces constants up to the
  /// boundary. The iteration converges to an interpolant of the divided functions.
  kPartition
};

struct ApproximateMlsOptions {
  /// Approximation order 2, 4 or 6 (d = 0, 1, 2) on regular samples. On irregular ones order 2 with some iterations is
  /// better: functions of higher order have negative rings, which turn gaps between samples into errors.
  int order = 2;
  /// ε, dimensionless. Small: smooth and wide (supports grow with 1/√ε). Large: the saturation error, about exp(−π²/ε)
  /// of the values times a factor that grows with the order, is visible between samples.
  double shape = 1;
  /// h, a length > 0. Unset: SampleIndex::spacing().
  std::optional<double> spacing = {};
  /// n >= 0: number of corrections by the approximation of the residual.
  int iterations = 4;
  Normalisation normalisation = Normalisation::kPartition;
  /// |φ| below this fraction of its peak is taken for zero, in (0, 0.1].
  double cutoff = 1e-5;
  /// Largest number of non-zero entries of K (12 bytes each); more throws DataError.
  std::size_t max_entries = std::size_t{1} << 30;
};

}  // namespace sansmesh::inline v1
