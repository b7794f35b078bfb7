// Samples in cells as a continuous function: what `linear` is where values belong to cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1 {

/// Linear on tetrahedra between the sample of a cell, a face's middle and two of its corners. Values at corners are
/// those of the plane of least squares through the samples of the cells around, within the range of these; at the
/// surface of the volume through the next ones, too, and beyond their range by at most one and a half times it, so that
/// linear functions are reproduced up to the surface. Values in the middle of a face are the means of its corners.
class CellInterpolant {
 public:
  /// `volume` has samples in cells and is no lattice; both must outlive it.
  CellInterpolant(const SampledVolume& volume, const VolumeValues& values);

  /// At x in (or near) the cell of a place; values and gradients (if wanted) have one entry a component.
  void evaluate(const VolumePlace& place, const Vec3& x, std::span<double> values, std::span<Vec3> gradients) const;

  /// The value at a corner of cells, and whether that is on the surface of the volume, where values go beyond samples.
  double at_corner(std::size_t corner, std::size_t component) const {
    return at_corners_[corner * values_.components + component];
  }
  bool is_outer(std::size_t corner) const { return outer_[corner] != 0; }
  /// Takes another value at a corner of cells than the plane's.
  void set_at_corner(std::size_t corner, std::size_t component, double value) {
    at_corners_[corner * values_.components + component] = value;
  }

 private:
  const SampledVolume& volume_;
  const VolumeValues& values_;
  std::vector<double> at_corners_;
  std::vector<std::uint8_t> outer_;
};

}  // namespace sansmesh::inline v1
