// An even choice from many points.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Indices, ascending, of points no two of which are closer than `radius` (length, > 0), such that every other point is
/// closer than that to one of them. They are chosen in a fixed, scattered order, not in that of the array. O(n).
std::vector<std::uint32_t> poisson_discs(std::span<const Vec3> points, double radius);

}  // namespace sansmesh::inline v1
