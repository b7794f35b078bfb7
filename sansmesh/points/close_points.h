// Points that lie close together: as one, or as connected parts of a cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Of each point the index of the one that stands for it: itself, or the first point no farther than `distance`
/// (length,
/// >= 0) that stands for itself. So no two that stand for themselves are as close as that, and nobody moves farther.
/// Points that are not finite stand for themselves.
std::vector<std::uint32_t> close_representatives(std::span<const Vec3f> positions, double distance);

/// Connected parts of a cloud.
struct CloudComponents {
  std::vector<std::uint32_t> of_point;  ///< 0 is the part with the most points (of several, that of the first point)
  std::vector<std::size_t> points;      ///< of each part
  std::size_t size() const { return points.size(); }
};

/// Points no farther from each other than `distance` (length, >= 0) are connected; what is not finite, to nothing.
CloudComponents find_cloud_components(std::span<const Vec3f> positions, double distance, Progress& progress);

}  // namespace sansmesh::inline v1
