// The smallest box around points, however it is turned.
#pragma once

#include <array>
#include <vector>

#include "sansmesh/core/vec.h"

namespace sansmesh {

/// A box in any direction.
struct OrientedBox {
  std::array<Vec3, 3> axes{};     ///< orthonormal, right-handed
  std::array<double, 3> sizes{};  ///< along the axes, descending
  Vec3 center;
};

/// A box around the points that no turn about one of its axes makes smaller, the smallest of those found from several
/// starting positions: exact for boxes, otherwise not necessarily the smallest of all. Points are relative to an origin
/// of the caller's. Throws DataError if there are no finite points.
OrientedBox smallest_box(const std::vector<Vec3f>& points);

}  // namespace sansmesh
