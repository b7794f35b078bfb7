// Words for the quantities that curvature is shown by.
#pragma once

#include <string>
#include <string_view>

#include "sansmesh/surface/curvature_colors.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {

/// A range of curvatures of the input (per length or length²) in coordinates of so many lengths of the input.
double curvature_range(double range, CurvatureQuantity quantity, double unit);

}  // namespace sansmesh::inline v1
