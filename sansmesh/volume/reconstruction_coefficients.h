// What reconstructions compute once and keep: with it a field is made again without a fit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "sansmesh/core/shared_array.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/samples/local_polynomials.h"

namespace sansmesh::inline v1 {

/// Of mls-detail and amls; the other methods have none, they are quickly set up from the values. Plain arrays that are
/// never changed, in memory or in a mapped file.
struct ReconstructionCoefficients {
  LocalPolynomials polynomials;  ///< of amls with the iterated constants
  SharedArray<float> radii;      ///< of the supports, in the local metrics; empty where cells are blended
  /// The values were multiplied by these before the fit, powers of two, one a component; empty: they were not.
  std::vector<double> scales;

  bool empty() const { return polynomials.size() == 0; }
  /// How many polynomials there are of each degree, 0 to 4; nothing where there are none.
  std::vector<std::size_t> by_degree() const;
  /// Throws DataError unless they are such as `method` has for that volume and an array of so many components: sizes
  /// fit, degrees are those that there are, every number is finite.
  void check(const SampledVolume& volume, std::size_t components, std::string_view method) const;
};

/// Whether the method blends functions of ellipsoidal support about samples (amls always; mls-detail where cells do not
/// fit together since blocks overlap, and where samples are corners of none), not polynomials in cells.
bool blends_supports(const SampledVolume& volume, std::string_view method);

}  // namespace sansmesh::inline v1
