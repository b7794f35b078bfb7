// Where in a cell a place lies: the map of a cell made ready to be inverted at many places.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/cells/cell_geometry.h"

namespace sansmesh::inline v1 {

/// The map of a cell with its linear part about the middle and bounds of the rest. Places are relative to the cell's
/// first corner, as its own corners are kept: what is nearby keeps all its digits.
class CellInverse {
 public:
  CellInverse() = default;
  /// `corners` in any coordinates.
  CellInverse(CellShape shape, std::span<const Vec3> corners);

  /// The parameters u whose place is `x`: the linear part's, and then Newton's method until that rests. False where it
  /// does not converge, or only far outside of the cell. The answer depends on the corners and on x alone.
  bool invert(const Vec3& x, Vec3& u) const {
    u = guess(x);
    if (!nearly_linear_) return newton(x, u);
    if (!linear_) u += by_rows(x - map_.at(u));
    return is_finite(u);
  }

  /// The parameters that the linear part tells: exact in tetrahedra and parallelepipeds.
  Vec3 guess(const Vec3& x) const { return middle_ + by_rows(x - center_); }

  /// False where x is certainly farther than `distance` from the cell: by the linear part and bounds of the rest. Much
  /// quicker than to find out by invert() that there is nothing.
  bool may_reach(const Vec3& x, double distance) const;

  CellShape shape() const { return shape_; }
  /// The place of parameters.
  Vec3 at(const Vec3& u) const { return map_.at(u); }

 private:
  Vec3 by_rows(const Vec3& d) const { return {dot(rows_[0], d), dot(rows_[1], d), dot(rows_[2], d)}; }
  bool newton(const Vec3& x, Vec3& u) const;

  CellShape shape_ = CellShape::tetrahedron;
  bool linear_ = false, nearly_linear_ = false, solvable_ = false;
  CellMap map_;
  std::array<Vec3, 3> rows_;        // of the inverse of the derivative in the middle
  Vec3 middle_, center_;            // parameters, and their place
  std::array<double, 3> curved_{};  // by how much each parameter of a place of the cell differs from the linear part's
  std::array<double, 3> reach_{};   // lengths of the rows
};

}  // namespace sansmesh::inline v1
