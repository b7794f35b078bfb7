// Results of neighbour queries, and the common distance function.
#pragma once

#include <cstdint>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Result of a query. Ordered by distance, then index, so that every query has a unique result.
struct Neighbour {
  float squared_distance;
  std::uint32_t index;
  friend bool operator==(const Neighbour&, const Neighbour&) = default;
  friend bool operator<(const Neighbour& a, const Neighbour& b) {
    return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance : a.index < b.index;
  }
};

/// ‖a − b‖² in a fixed order of operations that all queries use, so that results are bit-identical.
inline float squared_distance(const Vec3f& a, const Vec3f& b) {
  const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return x * x + y * y + z * z;
}

}  // namespace sansmesh::inline v1
