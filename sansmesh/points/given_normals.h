// What can be said of the normals that a cloud has.
#pragma once

#include <optional>
#include <string>

#include "sansmesh/cloud_options.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/orientation.h"
#include "sansmesh/points/sights.h"

namespace sansmesh::inline v1 {

/// By what is known of the sensor, or by how neighbours agree. `noise` of the points (length).
GivenNormals judge_normals(const PointSet& points, double noise);

GivenNormals judge_normals(const OrientationReport& report);

}  // namespace sansmesh::inline v1
