// The smallest box around points, however it is turned.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sansmesh/solid_measures.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The smallest box around all points that was found, exactly around them: of boxes with a side that faces in one of
/// 512 directions, or lies on three of the points where these are few, each turned as long as that makes it smaller.
/// Never larger than the upright one, nor than those along the frames in `also` (orthonormal, right-handed); exact for
/// boxes, otherwise not necessarily the smallest of all. Points are relative to an origin of the caller's.
/// Deterministic for any number of threads. Throws DataError if there are no finite points.
OrientedBox smallest_box(const std::vector<Vec3f>& points, std::span<const std::array<Vec3, 3>> also = {});

}  // namespace sansmesh::inline v1
