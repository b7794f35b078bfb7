// Coordinates of one's own, where they lie in those of the input, and maps that move what is in them.
#pragma once

#include <array>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct PointSet;
struct TriangleMesh;

/// Methods work in coordinates in which the samples are about 1 large: squares and sixth powers of lengths then stay
/// within float, whatever the unit of the input and however far away its origin. Position in the input = origin +
/// unit · own position. Lengths, values of a distance and boxes change accordingly, directions not at all.
///
/// A unit that is a power of two, as `frame_for` chooses it, rounds nothing: what is rounded is the sum or the
/// difference with the origin, once, to double. Own positions of some size s thus come back to within the resolution
/// of double at |origin| + unit · s: 10⁻¹⁰ at coordinates of 10⁶.
struct LocalFrame {
  Vec3 origin;      ///< of the own coordinates, in the input
  double unit = 1;  ///< length in the input of 1 in the own coordinates, > 0

  /// Position in the input.
  Vec3 to_input(const Vec3& x) const { return origin + x * unit; }
  /// Own position.
  Vec3 from_input(const Vec3& x) const { return (x - origin) * (1 / unit); }
  /// Own position of what lies at `offset` from a place of the input: nothing is lost where that place is near the
  /// origin.
  Vec3 from_input(const Vec3& at, const Vec3f& offset) const { return (at - origin + Vec3(offset)) * (1 / unit); }

  /// The box in the input; empty boxes stay empty.
  template <class T>
  Box3 to_input(const BoxT<T>& box) const {
    return box.empty() ? Box3{} : Box3{to_input(Vec3(box.lower)), to_input(Vec3(box.upper))};
  }
  /// The box in own coordinates; empty boxes stay empty.
  Box3 from_input(const Box3& box) const {
    return box.empty() ? Box3{} : Box3{from_input(box.lower), from_input(box.upper)};
  }

  /// Length in the input; also of values of a distance.
  double to_input(double length) const { return length * unit; }
  /// Own length.
  double from_input(double length) const { return length / unit; }

  /// Whether origin and unit are equal.
  friend bool operator==(const LocalFrame&, const LocalFrame&) = default;
};

/// The placement with that origin. The unit is the least power of two that is not smaller than `extent`, the size of
/// what is placed; 1 if that is 0.
SANSMESH_API LocalFrame frame_for(const Vec3& origin, double extent);

/// Brings a whole cloud (positions of scanners included) from the input to own coordinates; its origin becomes 0.
SANSMESH_API void move_from_input(PointSet& points, const LocalFrame& frame);
/// The same of a mesh.
SANSMESH_API void move_from_input(TriangleMesh& mesh, const LocalFrame& frame);
/// Brings a whole cloud from own coordinates to the input; its origin becomes that of `place`.
SANSMESH_API void move_to_input(PointSet& points, const LocalFrame& frame);
/// The same of a mesh.
SANSMESH_API void move_to_input(TriangleMesh& mesh, const LocalFrame& frame);

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
  /// Its matrix, a row after the other.
  std::array<std::array<double, 4>, 4> rows() const {
    return {{{x.x, y.x, z.x, shift.x}, {x.y, y.y, z.y, shift.y}, {x.z, y.z, z.z, shift.z}, {0, 0, 0, 1}}};
  }
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
