// Coordinates of one's own, and where they lie in those of the input.
#pragma once

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
/// A unit that is a power of two, as `placement_for` chooses it, rounds nothing: what is rounded is the sum or the
/// difference with the origin, once, to double. Own positions of some size s thus come back to within the resolution
/// of double at |origin| + unit · s: 10⁻¹⁰ at coordinates of 10⁶.
struct Placement {
  Vec3 origin;      ///< of the own coordinates, in the input
  double unit = 1;  ///< length in the input of 1 in the own coordinates, > 0

  Vec3 to_input(const Vec3& x) const { return origin + x * unit; }
  Vec3 from_input(const Vec3& x) const { return (x - origin) * (1 / unit); }
  /// Of what lies at `offset` from a place of the input: nothing is lost where that place is near the origin.
  Vec3 from_input(const Vec3& at, const Vec3f& offset) const { return (at - origin + Vec3(offset)) * (1 / unit); }

  /// Empty boxes stay empty.
  template <class T>
  Box3 to_input(const BoxT<T>& box) const {
    return box.empty() ? Box3{} : Box3{to_input(Vec3(box.lower)), to_input(Vec3(box.upper))};
  }
  Box3 from_input(const Box3& box) const {
    return box.empty() ? Box3{} : Box3{from_input(box.lower), from_input(box.upper)};
  }

  /// Lengths.
  double to_input(double length) const { return length * unit; }
  double from_input(double length) const { return length / unit; }

  friend bool operator==(const Placement&, const Placement&) = default;
};

/// The unit is the least power of two that is not smaller than `extent`, the size of what is placed; 1 if that is 0.
SANSMESH_API Placement placement_for(const Vec3& origin, double extent);

/// Positions of a whole cloud (those of scanners included) or mesh; its origin becomes 0 in own coordinates.
SANSMESH_API void move_from_input(PointSet& points, const Placement& place);
SANSMESH_API void move_from_input(TriangleMesh& mesh, const Placement& place);
SANSMESH_API void move_to_input(PointSet& points, const Placement& place);
SANSMESH_API void move_to_input(TriangleMesh& mesh, const Placement& place);

}  // namespace sansmesh::inline v1
