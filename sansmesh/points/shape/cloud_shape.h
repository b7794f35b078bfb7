// Dimension of the space that a cloud spans.
#pragma once

#include <optional>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Dimension of a cloud.
enum class CloudShape { empty, point, line, plane, volume };

/// Compares the extents along the principal axes with the largest one: an extent below 1e-6 of it (plus rounding of the
/// coordinates to float) counts as zero. Ignores non-finite positions.
CloudShape classify_shape(const PointSet& points);

/// Two parts of a cloud separated by empty space.
struct FarParts {
  double apart = 0;  ///< distance along the longest axis of the cloud (length)
  double size = 0;   ///< diagonal of the larger part's box (length)
};

/// Finds parts so far apart that the cloud appears to span fewer dimensions than one of them, or that float cannot
/// resolve the points of each. Nothing if classify_shape describes the cloud correctly.
std::optional<FarParts> find_far_parts(const PointSet& points);

}  // namespace sansmesh::inline v1
