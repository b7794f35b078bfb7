// Shape functions, parameters and inverse maps of the four cell shapes.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sansmesh/box.h"
#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A cell as the map X(u) = Σ_k a_k m_k(u) with the monomials m = 1, r, s, t, rs, st, rt, rst of u = (r, s, t).
/// Parameter domains: the unit cube for hexahedra and pyramids, the prism r, s ≥ 0, r + s ≤ 1, 0 ≤ t ≤ 1 for wedges,
/// the simplex r, s, t ≥ 0, r + s + t ≤ 1 for tetrahedra. The shape functions are VTK's.
class CellMap {
 public:
  CellMap() = default;
  /// `corners` relative to the query point, so that nearby cells keep full precision.
  CellMap(CellShape shape, std::span<const Vec3> corners);

  Vec3 at(const Vec3& u) const {
    if (shape_ == CellShape::tetrahedron) return a_[0] + a_[1] * u.x + a_[2] * u.y + a_[3] * u.z;
    return a_[0] + (a_[1] + a_[4] * u.y) * u.x + a_[2] * u.y +
           (a_[3] + a_[5] * u.y + (a_[6] + a_[7] * u.y) * u.x) * u.z;
  }
  /// ∂X/∂r, ∂X/∂s, ∂X/∂t.
  std::array<Vec3, 3> derivatives(const Vec3& u) const;

  /// Solves X(u) = 0 by Newton's method from the centre; false if it does not converge, or converges far outside the
  /// cell.
  bool invert(Vec3& u) const;
  /// Solves X(u) = x by Newton's method from u; false as invert().
  bool newton(const Vec3& x, Vec3& u) const;

  /// The coefficients of the nonlinear terms.
  struct Curvature {
    Vec3 rs, st, rt, rst;
  };
  Curvature curvature() const { return {a_[4], a_[5], a_[6], a_[7]}; }

 private:
  CellShape shape_ = CellShape::tetrahedron;
  std::array<Vec3, 8> a_;
};

/// Whether the map is inverted somewhere in the cell, judged at its corners: then a point may have several parameters,
/// and Newton's method may converge to parameters outside the cell.
bool is_folded(CellShape shape, std::span<const Vec3> corners);

/// The nearest parameters in the cell.
Vec3 clamped_parameters(CellShape shape, const Vec3& u);
/// Whether u is inside the cell by more than `margin`.
bool parameters_within(CellShape shape, const Vec3& u, double margin);

/// Values of the shape functions at u, one per corner.
void shape_functions(CellShape shape, const Vec3& u, std::span<double> weights);
/// Derivatives of the shape functions by r, s and t.
void shape_derivatives(CellShape shape, const Vec3& u, std::span<Vec3> derivatives);
/// Parameters of the point with these weights.
Vec3 parameters_of(CellShape shape, std::span<const double> weights);

/// The point of a cell nearest to the origin, by descent from several starts: slow, but correct for all cells,
/// including folded ones. Returns its squared distance.
double nearest_in_cell(CellShape shape, std::span<const Vec3> corners, std::span<double> weights);

/// The same on a face, a ring of three or four corners (a bilinear patch).
double nearest_on_face(std::span<const Vec3> ring, std::span<double> weights);

/// Signed volume: negative if the cell is inverted.
double cell_volume(CellShape shape, std::span<const Vec3> corners);
/// The squared lengths of the shortest and the longest edge.
struct EdgeRange {
  double shortest, longest;
};
EdgeRange squared_edges(CellShape shape, std::span<const Vec3> corners);

}  // namespace sansmesh::inline v1
