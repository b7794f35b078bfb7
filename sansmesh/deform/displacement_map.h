// A map of space kept as displacements on a lattice (METHODS §7.1; thesis 6.4.3): made once, then looked up by whoever
// draws or resamples through it.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/shared_array.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/progress.h"
#include "sansmesh/space_map.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// T(x) = x + D(x), D trilinear between the points of a lattice and the same as at the nearest place of its box outside
/// of that. Derivatives are 1 + those of D by differences over two cells, interpolated like D: continuous, and between
/// points more accurate than those of the interpolant itself.
class DisplacementMap final : public SpaceMap {
 public:
  /// Point (i, j, k) is number i + nx (j + ny k); the first and last of each axis lie on the box. `gaps` is empty where
  /// there are none, else as MapAnswers has them, but finite. Displacements are NaN where nothing is known. Throws
  /// ArgumentError unless the box has a size along each axis, the lattice at least 2 points, and the numbers agree.
  DisplacementMap(const Box3& box, const std::array<std::size_t, 3>& sizes, SharedArray<Vec3f> displacements,
                  SharedArray<float> gaps = {});

  const Box3& box() const { return box_; }
  const std::array<std::size_t, 3>& sizes() const { return sizes_; }
  const SharedArray<Vec3f>& displacements() const { return displacements_; }
  const SharedArray<float>& gaps() const { return gaps_; }

  void map(std::span<const Vec3> x, const MapAnswers& wanted) const override;
  bool has_gaps() const override { return !gaps_.empty(); }
  /// By the largest and least displacements of the cells that a box touches. Where a displacement is NaN it does not
  /// count.
  void images(std::span<const Box3> boxes, std::span<Box3> found) const override;

 private:
  /// A displacement with its differences along x, y, z: what eight of are mixed at a place.
  struct Node {
    Vec3f d, by[3];
    float gap = 0, gap_by[3]{};
  };
  struct Corners;
  bool corners_at(const Vec3& x, Corners& c) const;
  Node node_of(std::size_t p) const;
  Box3f bounds_of_points(const std::array<std::size_t, 3>& first, const std::array<std::size_t, 3>& last) const;

  Box3 box_;
  std::array<std::size_t, 3> sizes_{}, blocks_{};
  Vec3 spacing_;
  SharedArray<Vec3f> displacements_;
  SharedArray<float> gaps_;
  std::vector<Box3f> block_bounds_;  ///< of blocks of points
  std::vector<Node> nodes_;          ///< kept while they are not too many
};

/// Points of a lattice of about cubic cells over a box, `longest` (>= 2) along its longest side, at least 2 along each.
std::array<std::size_t, 3> lattice_sizes(const Box3& box, std::size_t longest);

/// A map on a lattice of 2 to 4096 points an axis over a box; `gaps` only if the map has some, no farther below 0 than
/// the box is wide. The stage of `progress` is "displacement map". Throws ArgumentError as the constructor does.
DisplacementMap displacement_map(const SpaceMap& map, const Box3& box, const std::array<std::size_t, 3>& sizes,
                                 Progress& progress);

/// A lattice with the arrays `displacement` (3 floats) and, where there are gaps, `gap` (1 float); and back. Throws
/// DataError where a block is no lattice of even spacing along the axes, or lacks the first array.
GridBlock displacement_block(const DisplacementMap& map);
DisplacementMap displacement_map_of(const GridBlock& block);

}  // namespace sansmesh::inline v1
