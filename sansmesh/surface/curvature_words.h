// Range of curvature values for colour maps.
#pragma once

#include "sansmesh/surface/curvature_colors.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {

/// Converts a range of curvatures of the input (1 / length, or 1 / length² for Gaussian curvature) to coordinates whose
/// unit is `unit` lengths of the input.
double curvature_range(double range, CurvatureQuantity quantity, double unit);

}  // namespace sansmesh::inline v1
