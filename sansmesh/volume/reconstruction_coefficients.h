// Stored coefficients of reconstructions, which recreate a field without a fit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "sansmesh/core/shared_array.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/samples/local_polynomials.h"

namespace sansmesh::inline v1 {

/// Only mls-detail and amls have polynomials; other methods are quick to set up from the values. Immutable arrays in
/// memory or in a mapped file.
struct ReconstructionCoefficients {
  LocalPolynomials polynomials;  ///< for amls with the iterated constants
  SharedArray<float> radii;      ///< support radii in the local metrics; empty where cells are blended
  /// Powers of two that scaled the values before the fit, one per component; empty: not scaled.
  std::vector<double> scales;
  /// Samples after smoothing (unit of the array, all components of each), so that they need not be smoothed again;
  /// empty if they are not smoothed.
  SharedArray<double> smoothed;
  double noise = 0;            ///< deviation of the noise that was smoothed (of the component with most)
  bool keep_smoothed = false;  ///< asks a fit for `smoothed`

  /// Whether there are no polynomials.
  bool empty() const { return polynomials.size() == 0; }
  /// Number of polynomials of each degree, 0 to 4; empty without polynomials.
  std::vector<std::size_t> by_degree() const;
  /// Throws DataError unless they are valid for `method` on that volume and number of components: matching sizes, valid
  /// degrees, finite numbers.
  void check(const SampledVolume& volume, std::size_t components, std::string_view method) const;
};

/// Whether the method blends functions with ellipsoidal supports (amls always; mls-detail for non-conforming cells of
/// overlapping blocks, and for samples that are no cell corners) instead of polynomials in cells.
bool blends_supports(const SampledVolume& volume, std::string_view method);

}  // namespace sansmesh::inline v1
