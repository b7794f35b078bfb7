// An operator that moves points onto a surface: the other way to define one, beside the zero set of a field.
#pragma once

#include <cstdint>
#include <span>

#include "sansmesh/box.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Where a point went, and the surface around that place: over the tangent plane at `position` its height along
/// `normal` is ½ (xx u² + 2 xy u v + yy v²), with (u, v) the coordinates along the vectors t, b that
/// tangent_frame(normal, t, b) gives. xx, xy, yy: curvature (1 / length), positive where the surface bends towards the
/// normal.
struct FootPoint {
  Vec3 position;
  Vec3 normal;  ///< unit, outward
  double xx = 0, xy = 0, yy = 0;
  bool defined = false;  ///< false: too far from the samples; then position is the point itself, the rest zero
};

/// The surface is the set of points that stay where they are (METHODS §2.1, §2.2). Spreads large batches over threads
/// itself, as a ScalarField does.
class Projection {
 public:
  virtual ~Projection() = default;

  /// Where the operator is defined, at most.
  virtual Box3 bounds() const = 0;

  /// Applies the operator once to each of x. Neighbouring points in neighbouring slots go fastest. Sizes must agree.
  /// Safe from several threads.
  virtual void project(std::span<const Vec3> x, std::span<FootPoint> feet) const = 0;
};

/// Applies the operator until a step is shorter than `tolerance` (length) or `steps` were made: points of the surface,
/// to that tolerance. Points that leave the domain on their way are undefined.
void project_to_fixed_point(const Projection& projection, std::span<const Vec3> x, double tolerance, int steps,
                            std::span<FootPoint> feet);

/// The signed distance to the foot point, ⟨x − p(x), n(x)⟩, with n as its gradient: lets polygonisers and ray casters
/// treat a projection like any other field. Undefined points are outside of the domain; their values are those of
/// another field, or the diagonal of the box.
class ProjectionField : public ScalarField {
 public:
  /// `projection` and `beyond` must outlive the field.
  explicit ProjectionField(const Projection& projection, const ScalarField* beyond = nullptr)
      : projection_(projection), beyond_(beyond) {}
  Box3 bounds() const override { return projection_.bounds(); }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                          std::span<std::uint8_t> inside) const override;

 private:
  const Projection& projection_;
  const ScalarField* beyond_;
};

}  // namespace sansmesh::inline v1
