// Curvatures of surfaces and level sets: the interface of principal curvatures at surface points, and their computation
// from a field.
#pragma once

#include <span>

#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Eigenvalues and eigenvectors of the symmetric form [[xx, xy], [xy, yy]] on the tangent plane with these axes.
PrincipalCurvatures principal_curvatures_of(float xx, float xy, float yy, const Vec3f& x_axis, const Vec3f& y_axis);

/// Principal curvatures at surface points. Distributes large batches over threads, as ScalarField does.
class CurvatureField {
 public:
  virtual ~CurvatureField() = default;
  /// Computes curvatures at points on or near the surface, seen from the side of the given unit normals: reversing a
  /// normal exchanges convex and concave. Sizes must agree. Thread-safe.
  virtual void evaluate(std::span<const Vec3> x, std::span<const Vec3f> normals,
                        std::span<PrincipalCurvatures> curvatures) const = 0;
};

/// Curvatures of a field's level sets from differences of the gradient over ±step in the tangent plane, that is, at
/// the scale of the step. Works for all fields with smooth gradients at that scale, including projections.
class LevelSetCurvature final : public CurvatureField {
 public:
  /// The field must outlive this object. Throws ArgumentError unless the step (length) is positive.
  LevelSetCurvature(const ScalarField& field, double step);
  /// Undefined where the field is undefined at the point or a step beside it.
  void evaluate(std::span<const Vec3> x, std::span<const Vec3f> normals,
                std::span<PrincipalCurvatures> curvatures) const override;

 private:
  const ScalarField& field_;
  double step_;
};

/// Computes values, gradients and curvatures of the level sets at all of x, which need not be on a surface; sizes must
/// agree. Second derivatives are central differences of gradients over ±step (length > 0). The step should be short
/// compared with the radii of curvature and long compared with the rounding errors of gradients: for single-precision
/// fields, a hundredth of the sample spacing is too short, a quarter is suitable.
void level_set_points(const ScalarField& field, std::span<const Vec3> x, double step, std::span<LevelSetPoint> result);

}  // namespace sansmesh::inline v1
