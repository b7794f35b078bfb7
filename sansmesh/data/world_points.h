// Positions relative to an origin, as points of the input in double precision.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// All positions, in order.
std::vector<Vec3> world_points(const Vec3& origin, std::span<const Vec3f> positions);
/// Appends the finite positions.
void add_finite_points(const Vec3& origin, std::span<const Vec3f> positions, std::vector<Vec3>& points);
/// Bounding box of the finite positions.
Box3 finite_bounds(const Vec3& origin, std::span<const Vec3f> positions);

}  // namespace sansmesh::inline v1
