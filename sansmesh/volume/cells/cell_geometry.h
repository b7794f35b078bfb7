// The four shapes of cells as maps of a cube: places in them, and back.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sansmesh/box.h"
#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A cell as the map X(u) = Σ_k a_k m_k(u) with the monomials m = 1, r, s, t, rs, st, rt, rst of u = (r, s, t). The
/// parameters of hexahedra and pyramids lie in the unit cube, those of wedges in the prism r, s ≥ 0, r + s ≤ 1, 0 ≤ t ≤
/// 1, those of tetrahedra in the simplex r, s, t ≥ 0, r + s + t ≤ 1: the shape functions are VTK's.
class CellMap {
 public:
  CellMap() = default;
  /// `corners` relative to where the map is asked: what is nearby keeps all its digits.
  CellMap(CellShape shape, std::span<const Vec3> corners);

  Vec3 at(const Vec3& u) const {
    if (shape_ == CellShape::tetrahedron) return a_[0] + a_[1] * u.x + a_[2] * u.y + a_[3] * u.z;
    return a_[0] + (a_[1] + a_[4] * u.y) * u.x + a_[2] * u.y +
           (a_[3] + a_[5] * u.y + (a_[6] + a_[7] * u.y) * u.x) * u.z;
  }
  /// ∂X/∂r, ∂X/∂s, ∂X/∂t.
  std::array<Vec3, 3> derivatives(const Vec3& u) const;

  /// u with X(u) = 0 by Newton's method from the middle; false where that does not converge, or only far outside of the
  /// cell.
  bool invert(Vec3& u) const;

  /// The coefficients of what is not linear.
  struct Curvature {
    Vec3 rs, st, rt, rst;
  };
  Curvature curvature() const { return {a_[4], a_[5], a_[6], a_[7]}; }

 private:
  CellShape shape_ = CellShape::tetrahedron;
  std::array<Vec3, 8> a_;
};

/// Whether the map turns inside out somewhere in the cell, as far as its corners tell: then a place may have several
/// parameters, and Newton's method may find those that are not in the cell.
bool is_folded(CellShape shape, std::span<const Vec3> corners);

/// The nearest parameters that belong to the cell.
Vec3 clamped_parameters(CellShape shape, const Vec3& u);
/// Whether u lies in the cell, by more than `margin`.
bool parameters_within(CellShape shape, const Vec3& u, double margin);

/// Values of the shape functions at u, one a corner.
void shape_functions(CellShape shape, const Vec3& u, std::span<double> weights);
/// Their derivatives by r, s and t.
void shape_derivatives(CellShape shape, const Vec3& u, std::span<Vec3> derivatives);
/// Parameters of a place from its weights.
Vec3 parameters_of(CellShape shape, std::span<const double> weights);

/// The place of a cell that is nearest to the origin, by descent from several starts: slow, and right for cells of all
/// kinds, also folded ones. Returns its squared distance.
double nearest_in_cell(CellShape shape, std::span<const Vec3> corners, std::span<double> weights);

/// The same on a face, a ring of three or four corners (a bilinear patch).
double nearest_on_face(std::span<const Vec3> ring, std::span<double> weights);

/// Signed: negative where the cell is inside out.
double cell_volume(CellShape shape, std::span<const Vec3> corners);
/// The squared lengths of the shortest and of the longest edge.
struct EdgeRange {
  double shortest, longest;
};
EdgeRange squared_edges(CellShape shape, std::span<const Vec3> corners);

}  // namespace sansmesh::inline v1
