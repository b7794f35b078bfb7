// Spatially coherent orders of points.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Compares by x, then y, then z.
inline bool lexicographic_less(const Vec3& a, const Vec3& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// An order along the Morton curve of the points' box (equal codes by index; non-finite points last). Empty for few
/// points, and where consecutive points are close together already (lines, images, lattices): sorting would cost more
/// than it gains.
std::vector<std::uint32_t> locality_order(std::span<const Vec3> points);

/// All points along that curve, equal codes by x, y and z, coincident points by `before`, a strict order of their
/// indices, so that the result is independent of the order in the list. Non-finite points come last, in their given
/// order.
std::vector<std::uint32_t> canonical_point_order(std::span<const Vec3> points,
                                                 const std::function<bool(std::uint32_t, std::uint32_t)>& before);

}  // namespace sansmesh::inline v1
