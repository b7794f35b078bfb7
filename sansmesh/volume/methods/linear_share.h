// Share of linear interpolation in blended polynomials.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/grid/volume_values.h"
#include "sansmesh/volume/methods/cell_interpolant.h"
#include "sansmesh/volume/samples/local_polynomials.h"

namespace sansmesh::inline v1 {

/// Linear interpolation of a volume that is no lattice, and its share s, which is interpolated as it is: (1 − trust)²
/// at samples in cells, 1 − trust at corners (docs/methods/volume-reconstruction.md, Blending). s = 0 in cells where
/// linear interpolation is not continuous: with partial neighbours, and where cells of several blocks overlap; with
/// `only_outside` at samples and corners inside the volume, too.
class LinearShare {
 public:
  /// `volume` must outlive the object. Runs in parallel.
  LinearShare(const SampledVolume& volume, const VolumeValues& values, const LocalPolynomials& polynomials,
              bool only_outside = false);

  /// Linear interpolation of samples in cells; none for samples at corners.
  const CellInterpolant* interpolant() const { return interpolant_ ? &*interpolant_ : nullptr; }
  /// Whether the share is positive anywhere in a cell.
  bool has(std::size_t cell) const { return any_[cell] != 0; }
  /// Values, and the share as the last one; and their gradients, if requested.
  void evaluate(const CellLocation& location, const Vec3& x, std::span<double> values, std::span<Vec3> gradients) const;

 private:
  struct Near {
    std::vector<std::uint32_t> own, next;
  };

  void share_at_corners();
  void share_in_cells(const LocalPolynomials& polynomials, bool only_outside);
  double& share_of(std::size_t sample) { return joint_.values[(sample + 1) * joint_.components - 1]; }
  double outer_share(const LocalPolynomials& polynomials, std::size_t corner, std::span<const std::uint32_t> cells,
                     Near& near) const;

  const SampledVolume& volume_;
  VolumeValues joint_;  // per sample: components, then the share
  std::optional<CellInterpolant> interpolant_;
  std::vector<std::uint8_t> any_;  // per cell
};

}  // namespace sansmesh::inline v1
