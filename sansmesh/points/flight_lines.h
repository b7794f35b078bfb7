// Where the sensor of a survey from the air was, seen from each sample.
#pragma once

#include <vector>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Unit directions from the samples to the sensor that saw them, which flew above; empty if the attributes do not tell.
/// The scan angle θ of a sample (degrees from straight down) says how far aside of the path it lies: of each stretch of
/// a flight line the positions are a + v t + w tan θ for the time t, with w across the path and as long as the flight
/// is high, by least squares; the sensor is in direction (−w sin θ / ‖w‖, cos θ). Which side has positive angles, and
/// how high the flight was, follows from that. Flight lines are told apart by point_source_id and by pauses of
/// gps_time, and cut in stretches so short that they are straight. Where that fit explains the positions badly, the
/// direction is up. Names of attributes as in LAS, or as PDAL and CloudCompare write them.
std::vector<Vec3f> directions_to_flight(const PointSet& points);

/// Whether attributes say so: returns of pulses, or scan angles.
bool is_survey_from_above(const PointSet& points);

}  // namespace sansmesh::inline v1
