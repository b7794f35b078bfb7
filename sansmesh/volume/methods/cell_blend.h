// The field of polynomials about samples, blended in the cells that these are corners of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/kernels/cell_blend_kernels.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// Polynomials about samples, one for each component.
class CornerPolynomials {
 public:
  virtual ~CornerPolynomials() = default;
  virtual std::size_t components() const = 0;
  /// The polynomials of up to eight samples, corners of one cell, for one component. Constants and values are less that
  /// of the first one, which is returned.
  virtual double corners(std::span<const std::uint32_t> samples, std::size_t component,
                         std::span<detail::CellCorner> out) const = 0;
};

/// F(x) = Σ_v S_v(x) (τ_v p_v(x) + (1 − τ_v) L(x)) in each cell, S_v as in blend_weights, L the linear interpolation.
/// Outside of the volume: at the nearest place of it, shifted outwards by at most half the distance between samples.
/// `volume` has samples at the corners of its cells, or is a lattice.
std::unique_ptr<VolumeField> make_cell_blend(std::shared_ptr<const SampledVolume> volume,
                                             std::shared_ptr<const VolumeLocator> locator,
                                             std::unique_ptr<CornerPolynomials> polynomials);

}  // namespace sansmesh::inline v1
