// Field of sample polynomials, blended in the cells with these samples as corners.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/kernels/cell_blend_kernels.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// Polynomials of samples, one for each component.
class CornerPolynomials {
 public:
  virtual ~CornerPolynomials() = default;
  virtual std::size_t components() const = 0;
  /// The values of the samples, for interpolation.
  virtual const VolumeValues& values() const = 0;
  /// The polynomials of up to eight samples, the corners of one cell, for one component. Constants and values are
  /// relative to the constant of the first corner, which is returned.
  virtual double corners(std::span<const std::uint32_t> samples, std::size_t component,
                         std::span<detail::CellCorner> out) const = 0;
};

/// F(x) = Σ_v S_v(x) (τ_v p_v(x) + (1 − τ_v) L(x)) in each cell, S_v from blend_weights, L the linear interpolation,
/// or that of HigherOrderFunctions.
/// Outside the volume: the value at its nearest point, shifted outwards by at most half the sample distance. `volume`
/// has samples at the corners of its cells, or is a lattice.
std::unique_ptr<VolumeField> make_cell_blend(std::shared_ptr<const SampledVolume> volume,
                                             std::shared_ptr<const VolumeLocator> locator,
                                             std::unique_ptr<CornerPolynomials> polynomials);

}  // namespace sansmesh::inline v1
