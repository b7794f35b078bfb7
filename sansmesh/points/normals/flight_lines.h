// Directions to the sensor of an airborne survey.
#pragma once

#include <vector>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Unit directions from the samples to the sensor above them; empty if attributes are missing. The scan angle θ of a
/// sample (degrees from nadir) gives its distance from the flight path: for each stretch of a flight line, least
/// squares fits the positions a + v t + w tan θ at time t, with w perpendicular to the path and as long as the flight
/// height. The sensor direction is (−w sin θ / ‖w‖, cos θ). The fit determines the side of positive angles and the
/// flight height. Flight lines are separated by point_source_id and by pauses of gps_time, and divided into
/// approximately straight stretches. Where the fit explains the positions poorly, the direction is up. Attribute names
/// as in LAS, PDAL and CloudCompare.
std::vector<Vec3f> directions_to_flight(const PointSet& points);

/// Whether attributes indicate an airborne survey: returns of pulses, or scan angles.
bool is_survey_from_above(const PointSet& points);

}  // namespace sansmesh::inline v1
