// Precomputed inverse of a cell's map for many query points.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/cells/cell_geometry.h"

namespace sansmesh::inline v1 {

/// The map of a cell with its linear part about the centre and bounds of the rest. Query points and corners are
/// relative to the cell's first corner, so that nearby points keep full precision.
class CellInverse {
 public:
  CellInverse() = default;
  /// `corners` in any coordinates.
  CellInverse(CellShape shape, std::span<const Vec3> corners);

  /// The parameters u of the point `x`: starts at the linear part's and applies Newton's method until convergence.
  /// False if it does not converge, or converges far outside the cell. The result depends only on the corners and x.
  bool invert(const Vec3& x, Vec3& u) const {
    u = guess(x);
    if (!nearly_linear_) return map_.newton(x, u);
    if (!linear_) u += by_rows(x - map_.at(u));
    return is_finite(u);
  }

  /// The parameters by the linear part: exact in tetrahedra and parallelepipeds.
  Vec3 guess(const Vec3& x) const { return middle_ + by_rows(x - center_); }

  /// False if x is certainly farther than `distance` from the cell, by the linear part and bounds of the rest. Much
  /// cheaper than a failing invert().
  bool may_reach(const Vec3& x, double distance) const;

  CellShape shape() const { return shape_; }
  /// The point with these parameters.
  Vec3 at(const Vec3& u) const { return map_.at(u); }

 private:
  Vec3 by_rows(const Vec3& d) const { return {dot(rows_[0], d), dot(rows_[1], d), dot(rows_[2], d)}; }

  CellShape shape_ = CellShape::tetrahedron;
  bool linear_ = false, nearly_linear_ = false, solvable_ = false;
  CellMap map_;
  std::array<Vec3, 3> rows_;        // rows of the inverse derivative at the centre
  Vec3 middle_, center_;            // parameters of the centre, and its position
  std::array<double, 3> curved_{};  // largest deviation of each parameter from the linear part's, over the cell
  std::array<double, 3> reach_{};   // lengths of the rows
};

}  // namespace sansmesh::inline v1
