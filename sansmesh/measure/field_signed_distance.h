// Signed distance to the zero set of a function.
#pragma once

#include <span>

#include "sansmesh/measure/signed_distance.h"
#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1 {

/// Distance to the zero set of a function, negative inside; the function need not be a distance. Newton steps along the
/// gradient lead to the zero set, with bisection where they do not shrink; then steps in the tangent plane until the
/// line to the point is normal to it. The foot is a point of the zero set, to 1e-9 of the box's diagonal, or to the
/// accuracy limited by noise of the function below 1e-6 of it, and closest among its neighbours, though another part
/// may be closer. The sign is that of the function. Points with steps farther than `farthest` become NaN; points with
/// steps that leave the domain or do not converge are lost.
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
