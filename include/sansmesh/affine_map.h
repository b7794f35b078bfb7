// Affine maps of space, and clouds and meshes moved by them.
#pragma once

#include "sansmesh/api.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct PointSet;
struct TriangleMesh;

/// p → A p + shift, A by its columns.
struct SANSMESH_API AffineMap {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< column of A: where the unit vector of that axis goes
  Vec3 shift;                               ///< where 0 goes (length)

  /// A v: of a direction, or a difference of positions.
  Vec3 turn(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
  /// Of a position: A p + shift.
  Vec3 operator()(const Vec3& p) const { return turn(p) + shift; }
  /// det A, the factor of volumes. Negative where left becomes right.
  double determinant() const { return dot(x, cross(y, z)); }
  /// Whether A is the identity, exactly.
  bool only_shifts() const { return x == Vec3{1, 0, 0} && y == Vec3{0, 1, 0} && z == Vec3{0, 0, 1}; }
  /// The map p → this(first(p)).
  AffineMap after(const AffineMap& first) const;
  /// The map that undoes this one. Throws ArgumentError where the map flattens space: |determinant| is not above 1e-12
  /// of the product of the lengths of x, y and z.
  AffineMap inverse() const;
  /// The same map with `center` in the place of 0.
  AffineMap about(const Vec3& center) const;

  /// Rotation about an axis through 0, of any length, by an angle (degrees, counter-clockwise as the axis points at
  /// one's eye). Multiples of 90° about the coordinates' axes are exact. Throws ArgumentError for an axis without a
  /// direction, and for what is not finite.
  static AffineMap rotation(const Vec3& axis, double degrees);
  /// Scales each coordinate by its factor, about 0; negative factors mirror.
  static AffineMap scaling(const Vec3& factors) {
    return {{factors.x, 0, 0}, {0, factors.y, 0}, {0, 0, factors.z}, {}};
  }
  /// p → p + shift.
  static AffineMap translation(const Vec3& shift) { return {.shift = shift}; }

  /// Whether all twelve numbers are equal.
  friend bool operator==(const AffineMap&, const AffineMap&) = default;
};

/// Moves everything that has a place or a direction: positions, normals (which stay at right angles to the surface,
/// whatever the map does, and unit), scanners, normals of grids. A map that turns left into right also turns the
/// triangles over, so that their outside stays outside. The origin moves in double; where the map only shifts, nothing
/// else changes, and no digit is lost. Attributes stay as they are. Throws ArgumentError, before anything is changed,
/// as `inverse`, and for maps that are not finite, throw positions beyond 1e18 or shrink everything below 1e-18.
SANSMESH_API void transform(PointSet& points, const AffineMap& map);
/// The same of a mesh.
SANSMESH_API void transform(TriangleMesh& mesh, const AffineMap& map);

}  // namespace sansmesh::inline v1
