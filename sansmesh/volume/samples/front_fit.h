// Least-squares fit of a front between two values to means over cells.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Cells of a stencil as tetrahedra, relative to the middle cell.
struct FrontCells {
  struct Cell {
    Vec3 center;
    double radius = 0;            ///< largest distance of a corner from the center
    double mean = 0, weight = 0;  ///< weight of the square of its deviation
    std::size_t first = 0, last = 0;
  };
  std::vector<Cell> cells;
  std::vector<std::array<Vec3, 4>> tetrahedra;
};

/// a + (b − a) [g > 0], smoothed; g(y) = ⟨n, y⟩ + p_1 y_1 + p_2 y_2 − d + ½ (k_11 y_1² + 2 k_12 y_1 y_2 + k_22 y_2²)
/// with the tangents y_k = ⟨t_k, y⟩.
struct FrontShape {
  Vec3 normal, tangent1, tangent2;
  double offset = 0, slope1 = 0, slope2 = 0, bend11 = 0, bend12 = 0, bend22 = 0;
  double low = 0, high = 0;
  double spread = 0;     ///< half the distance of the two steps of which the front consists (length)
  double deviation = 0;  ///< root mean square of means minus fit
};

/// The share of a tetrahedron where a linear function is positive, from its values at the corners, and the derivative
/// of the share if the same number is added to all values.
struct ShareBehind {
  double share = 0, slope = 0;
};
ShareBehind share_behind(std::array<double, 4> values);

/// The share of a cell behind the front.
double share_behind(const FrontCells& cells, const FrontCells::Cell& cell, const FrontShape& front, double size);

/// Fits a front of a fixed spread, whose values rise along `normal` (unit), to the cells; `size` is the extent of the
/// middle cell along it. False if the means do not determine it.
bool fit_front(const FrontCells& cells, const Vec3& normal, double size, FrontShape& front);
/// Fits the spread, too. False as above.
bool fit_spread(const FrontCells& cells, double size, FrontShape& front);

}  // namespace sansmesh::inline v1
