// Curvature of a field's level sets, from the field alone.
#pragma once

#include <span>

#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1 {

/// A field at one place, and the principal curvatures of its level set there: 1 / length, positive where the set
/// {F <= F(x)} is convex, k1 >= k2; both 0 where the gradient vanishes.
struct LevelSetPoint {
  double value = 0;
  Vec3 gradient;
  double k1 = 0, k2 = 0;
  double mean_curvature() const { return 0.5 * (k1 + k2); }
  double gaussian_curvature() const { return k1 * k2; }
};

/// At all of x; sizes must agree. Second derivatives are central differences of gradients over ±step (length > 0):
/// short against the radii of curvature, long against the rounding of the gradients (a hundredth of the samples'
/// spacing is too short for fields in single precision, a quarter is right).
void level_set_points(const ScalarField& field, std::span<const Vec3> x, double step, std::span<LevelSetPoint> result);

}  // namespace sansmesh::inline v1
