// A map of space sampled as displacements on a lattice (tejada2008, 6.4.3), for repeated evaluation by rendering and
// resampling.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/shared_array.h"
#include "sansmesh/deform/maps/box_lattice.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/progress.h"
#include "sansmesh/space_map.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// T(x) = x + D(x) with D trilinear between lattice points, and outside the box equal to D at the nearest point of the
/// box. Derivatives are 1 + central differences of D over two cells, interpolated like D: continuous, and between
/// lattice points more accurate than those of the interpolant.
class DisplacementMap final : public SpaceMap {
 public:
  /// Point (i, j, k) has index i + nx (j + ny k); the first and last points of each axis are on the box. `gaps` is
  /// empty if there are none, else as in MappedPoints, but finite. Displacements are NaN where the map is undefined.
  /// Throws ArgumentError unless the box has a size along each axis, the lattice has at least 2 points per axis, and
  /// the array sizes agree.
  DisplacementMap(const Box3& box, const std::array<std::size_t, 3>& sizes, SharedArray<Vec3f> displacements,
                  SharedArray<float> gaps = {});

  const BoxLattice& lattice() const { return lattice_; }
  const SharedArray<Vec3f>& displacements() const { return displacements_; }
  const SharedArray<float>& gaps() const { return gaps_; }

  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override;
  bool has_gaps() const override { return !gaps_.empty(); }
  /// Bounds from the extreme displacements of the cells that a box touches; NaN displacements are ignored.
  void images(std::span<const Box3> boxes, std::span<Box3> found) const override;

 private:
  /// A displacement with its differences along x, y, z; a point interpolates eight of these.
  struct Node {
    Vec3f d, by[3];
    float gap = 0, gap_by[3]{};
  };
  struct Corners;
  bool corners_at(const Vec3& x, Corners& c) const;
  Node node_of(std::size_t p) const;
  Box3f bounds_of_points(const std::array<std::size_t, 3>& first, const std::array<std::size_t, 3>& last) const;

  BoxLattice lattice_;
  std::array<std::size_t, 3> blocks_{};
  SharedArray<Vec3f> displacements_;
  SharedArray<float> gaps_;
  std::vector<Box3f> block_bounds_;  ///< bounds of the displacements, per block of points
  std::vector<Node> nodes_;          ///< cached unless there are too many
};

/// Samples a map on a lattice of 2 to 4096 points per axis over a box. `gaps` is present only if the map has some; its
/// values are clamped from below to minus the box's width. The stage of `progress` is "displacement map". Throws
/// ArgumentError as the constructor does.
DisplacementMap displacement_map(const SpaceMap& map, const Box3& box, const std::array<std::size_t, 3>& sizes,
                                 Progress& progress);

/// Conversion to and from a lattice with the arrays `displacement` (3 floats) and, if there are gaps, `gap` (1 float).
/// Throws DataError if a block is no axis-aligned lattice of even spacing, or lacks the first array.
GridBlock displacement_block(const DisplacementMap& map);
DisplacementMap displacement_map_of(const GridBlock& block);

}  // namespace sansmesh::inline v1
