// Whether a cloud spans a volume, or less.
#pragma once

#include "sansmesh/data/point_set.h"

namespace sansmesh {

/// What a cloud spans.
enum class CloudShape { empty, point, line, plane, volume };

/// Extents along the principal axes, relative to the largest one: below 1e-6 (plus what rounding the coordinates to
/// float makes) there is none. Non-finite positions are ignored.
CloudShape classify_shape(const PointSet& points);

}  // namespace sansmesh
