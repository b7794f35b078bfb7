// Stretch of a map of space on a lattice, and the box of a deformed object.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/space_map.h"

namespace sansmesh::inline v1 {

/// Largest singular value of a Jacobian: the largest factor of lengths.
double largest_stretch(const Jacobian& j);

/// Stretch on a lattice over a box, interpolated trilinearly; constant continuation outside the box. Continuous and
/// positive. Where the map is undefined, it is the median of the defined nodes.
class MapStretch {
 public:
  /// `box` must be finite.
  MapStretch(const SpaceMap& map, const Box3& box);

  /// Stretch at x, and optionally its gradient.
  double at(const Vec3& x, Vec3* gradient = nullptr) const;
  struct Range {
    double least, most;
  };
  /// Range over at least the nodes of all cells that the bounding box of the ball meets, and of their neighbours; for
  /// large balls also over some nodes farther away.
  Range around(const Vec3& x, double radius) const;
  /// Range over all nodes.
  Range range() const { return all_; }

 private:
  double node(std::size_t i, std::size_t j, std::size_t k) const {
    return nodes_[i + counts_[0] * (j + counts_[1] * k)];
  }
  Box3 box_;
  std::array<std::size_t, 3> counts_{1, 1, 1};
  Vec3 inverse_;  // cells per length
  std::vector<double> nodes_;
  std::array<std::size_t, 3> blocks_{1, 1, 1};
  std::vector<Range> block_ranges_;  // ranges of blocks of nodes
  Range all_{1, 1};
};

/// Bounding box of all x with T(x) in `source` (finite), as far as it can be determined. Starts from an approximate box
/// (default: the inverse at points of the source) and grows it until no point of a lattice of 33² per face maps into
/// the source, widened by the variation of the map between lattice points. Then shrinks it to the cells of a lattice of
/// 32³ that may map into the source, plus their neighbours if the map has gaps. Throws DataError if nothing maps into
/// the source, or if growth exceeds a thousand times the source's size.
Box3 preimage_box(const SpaceMap& map, const Box3& source, std::optional<Box3> near = {});

}  // namespace sansmesh::inline v1
