// Whether a cloud spans a volume, or less.
#pragma once

#include <optional>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// What a cloud spans.
enum class CloudShape { empty, point, line, plane, volume };

/// Extents along the principal axes, relative to the largest one: below 1e-6 (plus what rounding the coordinates to
/// float makes) there is none. Non-finite positions are ignored.
CloudShape classify_shape(const PointSet& points);

/// Two parts of a cloud with nothing between them.
struct FarParts {
  double apart = 0;  ///< along the longest axis of the cloud (length)
  double size = 0;   ///< diagonal of the larger one's box (length)
};

/// Parts that lie so far from each other that the cloud seems to span less than one of them does, or that the points of
/// each cannot be told apart beside their distance. Nothing where a cloud is what classify_shape says.
std::optional<FarParts> find_far_parts(const PointSet& points);

}  // namespace sansmesh::inline v1
