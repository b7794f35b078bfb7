// Principal curvatures anywhere on a surface, from whatever knows them.
#pragma once

#include <span>

#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// How a surface bends at a place: 1 / length, *positive where it is convex* (bends away from the normal).
struct SurfaceBend {
  float k1 = 0, k2 = 0;          ///< k1 >= k2
  Vec3f direction1, direction2;  ///< unit, tangential, each up to its sign; to k1 and k2
  bool defined = false;          ///< false: not known there, and all is zero
  float mean() const { return 0.5f * (k1 + k2); }
};

/// Of a symmetric form [[xx, xy], [xy, yy]] on the tangent plane with these axes: its eigenvalues and their directions.
SurfaceBend principal_bend(float xx, float xy, float yy, const Vec3f& x_axis, const Vec3f& y_axis);

/// Spreads large batches over threads itself, as a ScalarField does.
class CurvatureField {
 public:
  virtual ~CurvatureField() = default;
  /// At points on or next to the surface, seen from the side that the unit normals there point to: what is convex from
  /// one side is concave from the other. Sizes must agree. Safe from several threads.
  virtual void evaluate(std::span<const Vec3> x, std::span<const Vec3f> normals,
                        std::span<SurfaceBend> bends) const = 0;
};

/// Of the level sets of a field, by how its gradient turns over ±step in the tangent plane: at the scale of the step,
/// therefore, and for any field whose gradients are smooth at that scale, that of a projection among them.
class FieldCurvature final : public CurvatureField {
 public:
  /// The field must outlive this. Throws ArgumentError unless the step (length) is positive.
  FieldCurvature(const ScalarField& field, double step);
  /// Not defined where the field is not, a step to either side.
  void evaluate(std::span<const Vec3> x, std::span<const Vec3f> normals, std::span<SurfaceBend> bends) const override;

 private:
  const ScalarField& field_;
  double step_;
};

}  // namespace sansmesh::inline v1
