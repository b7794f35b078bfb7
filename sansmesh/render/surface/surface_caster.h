// Ray casting on surfaces without a mesh: zero sets of fields, stationary points of projections (tejada2008, 2.2.3 and
// 4.5).
#pragma once

#include <memory>
#include <span>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/normal_field.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/render/scene/cast_ray.h"
#include "sansmesh/render_options.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct SurfaceCastOptions {
  /// Accuracy of hits: along the ray for fields, between the point and its foot for projections. A share of the radius
  /// of the local ball, 1e-6..0.1.
  double tolerance = 1e-3;
  /// Step lengths along the ray equal the distance to the surface that the field returns, within these shares of the
  /// ball's radius. Sheets closer together than the smallest step can be missed. Jumps to a root that the tangent
  /// predicts may be three times as long. 0.001 <= smallest <= largest <= 1.
  double smallest_step = 0.1, largest_step = 0.5;
  /// Largest distance from zero, as a share of the ball's radius, 0..1, at which a jump of a field's sign counts as a
  /// surface. Fields of patches that do not meet have no other surface between the patches.
  double jump = 0.01;
  /// Projections: rays start at their intersections with local approximations that are fitted once at the balls'
  /// centres (tejada2008, 4.5.1), instead of marching through the balls.
  bool stored = false;
  /// Better normals at hits; null: those of the field or projection. Must outlive the caster.
  const NormalField* normals = nullptr;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Built once; queries are thread-safe. Both sides of a surface are visible. The surface exists only inside the balls
/// and inside the domain of the field: rays find nothing across gaps of either. A ray that starts on the surface does
/// not hit it there.
class SurfaceCaster {
 public:
  /// The field or projection must outlive the caster. Balls that are not finite or have no radius are left out. Throws
  /// ArgumentError for bad options (`stored` with a field) and arrays of different length, DataError if no ball is
  /// left.
  SurfaceCaster(const ScalarField& field, const BallUnion& balls, const SurfaceCastOptions& options = {});
  SurfaceCaster(const Projection& projection, const BallUnion& balls, const SurfaceCastOptions& options = {});
  SurfaceCaster(SurfaceCaster&&) noexcept;
  SurfaceCaster& operator=(SurfaceCaster&&) noexcept;
  ~SurfaceCaster();

  /// The first surface point along each ray. Rays are advanced together with one call of the field per round. Fastest
  /// with a few hundred neighbouring rays per call, in an order in which spatial neighbours are adjacent. The result of
  /// a ray does not depend on the others. Sizes must agree.
  void cast(std::span<const CastRay> rays, std::span<CastHit> hits) const;

  /// The balls in use.
  const BallUnion& balls() const;
  CastCounts counts() const;

  /// Surface points next to the centres of the balls, with normals: a few steps along the gradient from each centre, or
  /// the projection. Points that do not arrive within their ball have a zero normal. Sizes as balls().
  void surface_points(std::span<Vec3f> positions, std::span<Vec3f> normals) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
