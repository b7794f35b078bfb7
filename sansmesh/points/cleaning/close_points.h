// Merges or connects points that are close together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Index of the representative of each point: itself, or the first representative within `distance` (length, >= 0).
/// No two representatives are that close, and no point moves farther. Non-finite points represent themselves.
std::vector<std::uint32_t> close_representatives(std::span<const Vec3f> positions, double distance);

/// Connected components of a cloud.
struct CloudComponents {
  std::vector<std::uint32_t>
      of_point;  ///< component of each point; 0 is the largest one (of equal ones, that of the first point)
  std::vector<std::size_t> points;  ///< number of points per component
  std::size_t size() const { return points.size(); }
};

/// Connects points within `distance` (length, >= 0) of each other; non-finite points stay isolated.
CloudComponents find_cloud_components(std::span<const Vec3f> positions, double distance, Progress& progress);

}  // namespace sansmesh::inline v1
