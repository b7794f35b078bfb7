// Affine maps of space, and clouds and meshes moved by them.
#pragma once

#include <array>

#include "sansmesh/api.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct PointSet;
struct TriangleMesh;

/// p → A p + shift, A by its columns.
struct SANSMESH_API AffineMap {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< where the axes go
  Vec3 shift;                               ///< where 0 goes (length)

  /// Of a direction, or a difference of positions.
  Vec3 turn(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3 operator()(const Vec3& p) const { return turn(p) + shift; }
  /// Negative where left becomes right.
  double determinant() const { return dot(x, cross(y, z)); }
  /// Whether nothing but the shift moves anything.
  bool only_shifts() const { return x == Vec3{1, 0, 0} && y == Vec3{0, 1, 0} && z == Vec3{0, 0, 1}; }
  /// Its matrix, a row after the other.
  std::array<std::array<double, 4>, 4> rows() const {
    return {{{x.x, y.x, z.x, shift.x}, {x.y, y.y, z.y, shift.y}, {x.z, y.z, z.z, shift.z}, {0, 0, 0, 1}}};
  }
  /// First `first`, then this.
  AffineMap after(const AffineMap& first) const;
  /// Throws ArgumentError where the map flattens space: |determinant| is not above 1e-12 of the product of the lengths
  /// of x, y and z.
  AffineMap inverse() const;
  /// The same map with `center` in the place of 0.
  AffineMap about(const Vec3& center) const;

  /// By an angle (degrees, counter-clockwise as the axis points at one's eye). Multiples of 90° about the coordinates'
  /// axes are exact. Throws ArgumentError for an axis without a direction, and for what is not finite.
  static AffineMap rotation(const Vec3& axis, double degrees);
  static AffineMap scaling(const Vec3& factors) {
    return {{factors.x, 0, 0}, {0, factors.y, 0}, {0, 0, factors.z}, {}};
  }
  static AffineMap translation(const Vec3& shift) { return {.shift = shift}; }

  friend bool operator==(const AffineMap&, const AffineMap&) = default;
};

/// Moves everything that has a place or a direction: positions, normals (which stay at right angles to the surface,
/// whatever the map does, and unit), scanners, normals of grids. A map that turns left into right also turns the
/// triangles over, so that their outside stays outside. The origin moves in double; where the map only shifts, nothing
/// else changes, and no digit is lost. Attributes stay as they are. Throws ArgumentError, before anything is changed,
/// as `inverse`, and for maps that are not finite, throw positions beyond 1e18 or shrink everything below 1e-18.
SANSMESH_API void transform(PointSet& points, const AffineMap& map);
SANSMESH_API void transform(TriangleMesh& mesh, const AffineMap& map);

}  // namespace sansmesh::inline v1
