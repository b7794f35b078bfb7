// By how much a map of space stretches lengths, and where what it shows lies: what fields seen through it need to know
// of it once.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/space_map.h"

namespace sansmesh::inline v1 {

/// The largest singular value of a Jacobian: what lengths are multiplied with at most.
double largest_stretch(const Jacobian& j);

/// The stretch on a lattice over a box, linear in between in all three directions; beyond the box that of its surface.
/// Continuous and positive. Where the map is not defined it is the median of where it is.
class MapStretch {
 public:
  /// `box` must be finite. So many nodes along its longest side, 2..256.
  MapStretch(const SpaceMap& map, const Box3& box, std::size_t nodes = 33);

  /// And its gradient.
  double at(const Vec3& x, Vec3* gradient = nullptr) const;
  struct Range {
    double least, most;
  };
  /// Of all nodes of the cells that a box around the ball meets and of those beside these, at least: of large balls
  /// some farther away count, too.
  Range around(const Vec3& x, double radius) const;
  /// Of all nodes.
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
  std::vector<Range> block_ranges_;  // of blocks of nodes
  Range all_{1, 1};
};

/// A box that holds all x with T(x) in `source` (finite), as far as can be found: from a box that is near it (default:
/// from the inverse at points of the source) it grows until no point of a lattice of 33² on each of its faces maps into
/// the source widened by what the map does between these points, then shrinks to the cells of a lattice of 32³ that
/// may, and where the map has gaps those beside them. Throws DataError where nothing maps there or there is no end to
/// it (growth stops at a thousand times the source's size).
Box3 box_before(const SpaceMap& map, const Box3& source, std::optional<Box3> near = {});

}  // namespace sansmesh::inline v1
