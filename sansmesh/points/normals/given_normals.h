// Assessment of the given normals of a cloud.
#pragma once

#include "sansmesh/cloud_options.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/normals/sensor_directions.h"
#include "sansmesh/points/orientation/orientation.h"

namespace sansmesh::inline v1 {

/// Uses the sensor, if known, or the agreement of neighbours. `noise` of the points (length).
GivenNormals judge_normals(const PointSet& points, double noise);

GivenNormals judge_normals(const OrientationReport& report);

}  // namespace sansmesh::inline v1
