// Robust plane of heights.
#pragma once

#include <span>
#include <vector>

namespace sansmesh::inline v1 {

/// Position relative to the place of the plane, with its weight.
struct PlaneValue {
  double x, y, z, weight;
};

/// Height at 0 and slopes.
struct LocalPlane {
  double height = 0, rise_x = 0, rise_y = 0;
};

/// Weighted least squares with reweighting: values several deviations off have no weight. `unit`: length that is large
/// compared to rounding errors. `scratch` saves allocations.
LocalPlane fit_local_plane(std::span<const PlaneValue> values, double unit, std::vector<double>& scratch);

}  // namespace sansmesh::inline v1
