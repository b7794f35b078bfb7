// Curvature of a field's level sets, from the field only.
#pragma once

#include <span>

#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1 {

/// Computes values, gradients and curvatures at all of x; sizes must agree. Second derivatives are central differences
/// of gradients over ±step (length > 0). The step should be short compared with the radii of curvature and long
/// compared with the rounding errors of gradients: for single-precision fields, a hundredth of the sample spacing is
/// too short, a quarter is suitable.
void level_set_points(const ScalarField& field, std::span<const Vec3> x, double step, std::span<LevelSetPoint> result);

}  // namespace sansmesh::inline v1
