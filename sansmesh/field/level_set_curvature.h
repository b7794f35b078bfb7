// Curvature of a field's level sets, from the field alone.
#pragma once

#include <span>

#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1 {

/// At all of x; sizes must agree. Second derivatives are central differences of gradients over ±step (length > 0):
/// short against the radii of curvature, long against the rounding of the gradients (a hundredth of the samples'
/// spacing is too short for fields in single precision, a quarter is right).
void level_set_points(const ScalarField& field, std::span<const Vec3> x, double step, std::span<LevelSetPoint> result);

}  // namespace sansmesh::inline v1
