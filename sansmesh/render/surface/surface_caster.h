// Rays against surfaces that were never meshed: zero sets of fields, stationary points of projections (METHODS §4).
#pragma once

#include <cstddef>
#include <cstdint>
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
  /// Where a ray has found the surface: along the ray for fields, between the point and its foot for projections. A
  /// share of the radius of the ball around that place, 1e-6..0.1.
  double tolerance = 1e-3;
  /// Steps along the ray are as long as the distance to the surface that the field tells, within these shares of the
  /// ball's radius: sheets closer to each other than the smallest step can be missed. Jumps to where the tangent
  /// predicts the surface may be three times as long. 0.001 <= smallest <= largest <= 1.
  double smallest_step = 0.1, largest_step = 0.5;
  /// Where a field changes its sign by a jump, no farther from zero on either side than this share of the ball's
  /// radius, there is a surface, too, 0..1: fields of patches that do not meet have no other between them.
  double jump = 0.01;
  /// Projections: rays start where they meet local approximations that are fitted once, at the balls' centres, as in
  /// the source, in place of marching through the balls.
  bool stored = false;
  /// Better normals of hits than those of the field or projection; null: theirs. Must outlive the caster.
  const NormalField* normals = nullptr;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Built once, then asked from any thread. Both sides of a surface count. The surface exists only inside the balls and
/// inside the domain of the field: nothing is found across gaps of either. A ray that starts on the surface does not
/// see it there.
class SurfaceCaster {
 public:
  /// The field or projection must outlive the caster; balls that are not finite or have no radius are left out. Throws
  /// ArgumentError for bad options (`stored` with a field) and arrays of different length, DataError where no ball is
  /// left.
  SurfaceCaster(const ScalarField& field, const BallUnion& balls, const SurfaceCastOptions& options = {});
  SurfaceCaster(const Projection& projection, const BallUnion& balls, const SurfaceCastOptions& options = {});
  SurfaceCaster(SurfaceCaster&&) noexcept;
  SurfaceCaster& operator=(SurfaceCaster&&) noexcept;
  ~SurfaceCaster();

  /// The first place on the surface along each ray. Rays are advanced together, one call of the field for all of them
  /// in each round: a few hundred neighbouring rays at a time, in an order in which neighbours in space are neighbours
  /// in the array, go fastest. What one ray finds does not depend on the others. Sizes must agree.
  void cast(std::span<const CastRay> rays, std::span<CastHit> hits) const;

  /// The balls that count.
  const BallUnion& balls() const;
  CastCounts counts() const;
  void reset_counts() const;

  /// Points of the surface next to the centres of the balls, with normals: from each centre a few steps downhill, or
  /// the projection. Those that do not arrive within their ball have a zero normal. Sizes as balls().
  void feet(std::span<Vec3f> positions, std::span<Vec3f> normals) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
