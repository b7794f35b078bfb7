// Lattices of evenly spaced points over a box.
#pragma once

#include <array>
#include <cstddef>

#include "sansmesh/box.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Point (i, j, k) has index i + nx (j + ny k); the first and last points of each axis are on the box.
struct BoxLattice {
  using Index = std::array<std::size_t, 3>;

  Box3 box;
  Index sizes{};  ///< points per axis
  Vec3 spacing;

  BoxLattice() = default;
  BoxLattice(const Box3& around, const Index& points) : box(around), sizes(points) {
    for (std::size_t k = 0; k < 3; ++k) spacing[k] = (box.upper[k] - box.lower[k]) / static_cast<double>(sizes[k] - 1);
  }

  std::size_t size() const { return sizes[0] * sizes[1] * sizes[2]; }
  /// Index step to the next point along each axis.
  Index strides() const { return {1, sizes[0], sizes[0] * sizes[1]}; }
  std::size_t point(const Index& i) const { return i[0] + sizes[0] * (i[1] + sizes[1] * i[2]); }
  Index index(std::size_t p) const { return {p % sizes[0], p / sizes[0] % sizes[1], p / sizes[0] / sizes[1]}; }
  Vec3 position(const Index& i) const {
    Vec3 x = box.lower;
    for (std::size_t k = 0; k < 3; ++k) x[k] += spacing[k] * static_cast<double>(i[k]);
    return x;
  }
  Vec3 position(std::size_t p) const { return position(index(p)); }

  /// Throws ArgumentError unless the box has a size and the lattice 2 to 4096 points along each axis. `user` names what
  /// needs the lattice: "a displacement map".
  void validate(const char* user) const;
  /// The lattice as a grid without arrays.
  GridBlock grid() const;
};

/// Sizes of a lattice of approximately cubic cells over a box: `longest` (>= 2) points along its longest side, at least
/// 2 along each.
BoxLattice::Index lattice_sizes(const Box3& box, std::size_t longest);

}  // namespace sansmesh::inline v1
