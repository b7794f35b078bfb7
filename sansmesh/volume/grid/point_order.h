// Neighbouring points in neighbouring slots.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// By x, then y, then z.
inline bool lexicographic_less(const Vec3& a, const Vec3& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// An order of the points along the Morton curve of their box (of equal codes by number; what is not finite last).
/// Empty where they are few, or where consecutive ones lie close together as they are (lines, images, lattices): then
/// to sort them costs more than it gains.
std::vector<std::uint32_t> locality_order(std::span<const Vec3> points);

/// All points along that curve, those of equal codes by x, y and z, those of one place by `before`, a strict order of
/// their numbers, so that no order of the points in the list shows. What is not finite comes last, as it stands.
std::vector<std::uint32_t> canonical_point_order(std::span<const Vec3> points,
                                                 const std::function<bool(std::uint32_t, std::uint32_t)>& before);

}  // namespace sansmesh::inline v1
