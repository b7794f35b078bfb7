// From where samples were seen: what a file knows that tells the side of a surface.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "sansmesh/cloud_options.h"
#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Those that say of each sample from where it was seen, in this order.
inline constexpr std::array kOrientationOrder{OrientBy::scanner, OrientBy::rows, OrientBy::flight, OrientBy::up};

/// For each sample the unit direction to where it was seen from, or zero where that is not known. Empty where nothing
/// of the kind is known, as of `automatic` and `propagation`. `up` is z, whatever the cloud is like.
std::vector<Vec3f> find_sights(const PointSet& points, OrientBy by);

/// The same as far as the cloud itself says so: `up` only where it is a height field, seen from above. `noise` (length)
/// as in `measure_height_field`.
std::vector<Vec3f> find_own_sights(const PointSet& points, OrientBy by, double noise);

/// The first in the order of trust of which something is known.
OrientBy first_known_orientation(const PointSet& points, double noise);

}  // namespace sansmesh::inline v1
