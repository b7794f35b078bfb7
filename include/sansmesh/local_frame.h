// Local frames (origin and scale) of numerical methods, and affine maps.
#pragma once

#include <array>
#include <memory>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct PointSet;
struct ReferenceSystem;
struct TriangleMesh;

/// Local frame: methods work in coordinates in which the samples have a size of about 1, so that squares and sixth
/// powers of lengths fit into float for any unit and origin of the input. Input position = origin + unit · local
/// position. Lengths, distance values and boxes scale accordingly; directions do not change.
///
/// A unit that is a power of two, as chosen by `frame_for`, rounds nothing; only the sum or difference with the
/// origin is rounded, once, to double. Local positions of size s are therefore recovered to the resolution of double at
/// |origin| + unit · s: 10⁻¹⁰ at coordinates of 10⁶.
struct LocalFrame {
  Vec3 origin;      ///< input position of the local origin
  double unit = 1;  ///< input length of the local length 1, > 0
  /// Reference system of the input coordinates; null if unknown. Clouds and meshes that are moved to input coordinates
  /// receive it.
  std::shared_ptr<const ReferenceSystem> reference = {};

  /// Local to input position.
  Vec3 to_input(const Vec3& x) const { return origin + x * unit; }
  /// Input to local position.
  Vec3 from_input(const Vec3& x) const { return (x - origin) * (1 / unit); }
  /// Local position of `at` + `offset`; loses no digits if `at` is near the origin.
  Vec3 from_input(const Vec3& at, const Vec3f& offset) const { return (at - origin + Vec3(offset)) * (1 / unit); }

  /// Box in input coordinates; empty boxes stay empty.
  template <class T>
  Box3 to_input(const BoxT<T>& box) const {
    return box.empty() ? Box3{} : Box3{to_input(Vec3(box.lower)), to_input(Vec3(box.upper))};
  }
  /// Box in local coordinates; empty boxes stay empty.
  Box3 from_input(const Box3& box) const {
    return box.empty() ? Box3{} : Box3{from_input(box.lower), from_input(box.upper)};
  }

  /// Input length; also for distance values.
  double to_input(double length) const { return length * unit; }
  /// Local length.
  double from_input(double length) const { return length / unit; }

  /// Whether origin and unit are equal.
  friend bool operator==(const LocalFrame& a, const LocalFrame& b) { return a.origin == b.origin && a.unit == b.unit; }
};

/// Frame with that origin. The unit is the least power of two not smaller than `extent`, the size of the object; 1 if
/// `extent` is 0.
SANSMESH_API LocalFrame frame_for(const Vec3& origin, double extent);

/// Converts a whole cloud, scanner positions included, from input to local coordinates; its origin becomes 0.
SANSMESH_API void move_from_input(PointSet& points, const LocalFrame& frame);
/// Same, for a mesh.
SANSMESH_API void move_from_input(TriangleMesh& mesh, const LocalFrame& frame);
/// Converts a whole cloud from local to input coordinates; its origin becomes that of the frame.
SANSMESH_API void move_to_input(PointSet& points, const LocalFrame& frame);
/// Same, for a mesh.
SANSMESH_API void move_to_input(TriangleMesh& mesh, const LocalFrame& frame);

struct PointSet;
struct TriangleMesh;

/// Affine map p → A p + shift; x, y, z are the columns of A.
struct SANSMESH_API AffineMap {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< columns of A: images of the unit vectors
  Vec3 shift;                               ///< image of 0 (length)

  /// A v, for directions and differences of positions.
  Vec3 linear(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
  /// A p + shift, for positions.
  Vec3 operator()(const Vec3& p) const { return linear(p) + shift; }
  /// det A, the factor of volumes. Negative if the map mirrors.
  double determinant() const { return dot(x, cross(y, z)); }
  /// Whether A is exactly the identity.
  bool is_translation() const { return x == Vec3{1, 0, 0} && y == Vec3{0, 1, 0} && z == Vec3{0, 0, 1}; }
  /// Rows of the 4×4 matrix.
  std::array<std::array<double, 4>, 4> rows() const {
    return {{{x.x, y.x, z.x, shift.x}, {x.y, y.y, z.y, shift.y}, {x.z, y.z, z.z, shift.z}, {0, 0, 0, 1}}};
  }
  /// Composition p → this(first(p)).
  AffineMap after(const AffineMap& first) const;
  /// Inverse map. Throws ArgumentError if the map is singular: |determinant| is not above 1e-12 of the product of the
  /// lengths of x, y and z.
  AffineMap inverse() const;
  /// Same linear map, with the fixed centre `center` instead of 0.
  AffineMap about(const Vec3& center) const;

  /// Rotation about an axis of any length through 0 by an angle (degrees, counter-clockwise when the axis points
  /// towards the viewer). Multiples of 90° about coordinate axes are exact. Throws ArgumentError for a zero axis and
  /// for values that are not finite.
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

/// Transforms all positions and directions: positions, normals (which stay unit and perpendicular to the surface under
/// any map), scanners, grid normals. A mirroring map also reverses the triangles, so that the outside stays outside.
/// The origin moves in double; a pure translation changes nothing else and loses no digit. Attributes stay unchanged.
/// Throws ArgumentError, before any change, as `inverse`, and for maps that are not finite, move positions beyond 1e18
/// or shrink all lengths below 1e-12.
SANSMESH_API void transform(PointSet& points, const AffineMap& map);
/// Same, for a mesh.
SANSMESH_API void transform(TriangleMesh& mesh, const AffineMap& map);

}  // namespace sansmesh::inline v1
