// Even selection from many points (Poisson disc sampling).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Ascending indices of a maximal set of points with pairwise distances of at least `radius` (length, > 0): every other
/// point is closer to one of them. Points are visited in a fixed scattered order, not in array order. O(n).
std::vector<std::uint32_t> poisson_discs(std::span<const Vec3> points, double radius);

}  // namespace sansmesh::inline v1
