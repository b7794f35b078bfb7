// Smallest oriented box around points.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sansmesh/solid_measures.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The smallest box found around all points, exactly enclosing: among boxes with a side that faces in one of 512
/// directions, or, for few points, contains three of them; each is then rotated as long as it shrinks. Never larger
/// than the axis-aligned box, nor than those along the frames in `also` (orthonormal, right-handed); exact for boxes,
/// otherwise not necessarily the global minimum. Points are relative to an origin chosen by the caller. Deterministic
/// for any number of threads. Throws DataError if there are no finite points.
OrientedBox smallest_box(const std::vector<Vec3f>& points, std::span<const std::array<Vec3, 3>> also = {});

}  // namespace sansmesh::inline v1
