// Order of points along a space-filling curve.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Indices of the points along the Morton curve of a grid of 2²¹ cells per axis with edge 1 / `scale` from `lower` on;
/// points of one cell keep their order.
std::vector<std::uint32_t> space_order(std::span<const Vec3> x, const Vec3& lower, double scale);

/// Same, with cells that fit to the longest side of the bounding box.
std::vector<std::uint32_t> space_order(std::span<const Vec3> x);

}  // namespace sansmesh::inline v1
