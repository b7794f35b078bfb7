// Directions from samples to the sensor, which determine the side of a surface.
#pragma once

#include <array>
#include <vector>

#include "sansmesh/cloud_options.h"
#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Sources with a direction per sample, in order of reliability.
inline constexpr std::array kOrientationOrder{OrientBy::scanner, OrientBy::rows, OrientBy::flight, OrientBy::up};

/// Unit direction from each sample to the sensor, zero if unknown. Empty if the cloud has no such data, and for
/// `automatic` and `propagation`. `up` is +z for any cloud.
std::vector<Vec3f> find_sensor_directions(const PointSet& points, OrientBy by);

/// Same, but `up` only if the cloud is a height field. `noise` (length) as in `measure_height_field`.
std::vector<Vec3f> find_own_sensor_directions(const PointSet& points, OrientBy by, double noise);

/// First source, in order of reliability, with known directions.
OrientBy first_known_orientation(const PointSet& points, double noise);

}  // namespace sansmesh::inline v1
