// Cell data as a continuous function: `linear` for cell data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1 {

/// Linear on tetrahedra between the sample of a cell, a face centre and two corners of the face. Corner values come
/// from the least-squares plane of the samples in the adjacent cells, clamped to their range; at the surface of the
/// volume from the next ones too, with at most one and a half times the range beyond it, in the share in which the
/// plane explains the samples, so that linear functions are reproduced up to the surface, and steps are not
/// extrapolated. The value at a face centre is the mean of the face corners.
class CellInterpolant {
 public:
  /// `volume` has cell data and is no lattice; both must outlive the object.
  CellInterpolant(const SampledVolume& volume, const VolumeValues& values);

  /// At x in (or near) the located cell; values and gradients (if requested) have one entry per component.
  void evaluate(const CellLocation& location, const Vec3& x, std::span<double> values, std::span<Vec3> gradients) const;

  /// The value at a cell corner, and whether the corner is on the surface of the volume, where values extrapolate.
  double at_corner(std::size_t corner, std::size_t component) const {
    return at_corners_[corner * values_.components + component];
  }
  bool is_outer(std::size_t corner) const { return outer_[corner] != 0; }
  /// Overrides the plane's value at a cell corner.
  void set_at_corner(std::size_t corner, std::size_t component, double value) {
    at_corners_[corner * values_.components + component] = value;
  }

 private:
  struct Wedge;
  void find_hulls();
  void try_face(std::uint32_t slot, const Vec3& tip, const Vec3& d, Wedge& best) const;

  const SampledVolume& volume_;
  const VolumeValues& values_;
  std::vector<double> at_corners_;
  std::vector<std::uint8_t> outer_;
  Adjacency hulls_;  ///< for each sample with several cells the slots of their outer faces; empty if none has
};

}  // namespace sansmesh::inline v1
