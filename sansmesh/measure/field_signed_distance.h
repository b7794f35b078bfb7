// How far a point lies from the zero set of a function, and on which side.
#pragma once

#include <span>

#include "sansmesh/measure/signed_distance.h"
#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1 {

/// Distance to the zero set of a function, negative inside, that need not be a distance itself: Newton steps along the
/// gradient onto the zero set, halving between its two sides where they do not shrink, then steps within its tangent
/// planes until the line to the point is normal to it. So the foot is a point of the zero set, to 1e-9 of the box's
/// diagonal or as well as the function's noise allows if that is below 1e-6 of it, and closest among its neighbours,
/// though another part may be closer still. The sign is the function's. NaN are points whose steps lead farther than
/// `farthest`, and lost those whose steps lead out of the domain or nowhere.
class FieldDistance : public SignedDistance {
 public:
  /// Keeps a reference to the field.
  explicit FieldDistance(const ScalarField& field) : field_(field) {}

  Box3 bounds() const override { return field_.bounds(); }
  void measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const override;

 private:
  const ScalarField& field_;
};

}  // namespace sansmesh::inline v1
