// Ray casting that starts from polynomials stored with the samples (tejada2008, 4.5.1, after Adamson & Alexa 2003).
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/render/scene/cast_ray.h"

namespace sansmesh::inline v1::detail {

/// Intersection of a ray with the polynomial of a ball inside that ball.
struct StoredHit {
  bool found = false;
  float distance = 0;  ///< along the ray
  std::uint32_t ball = 0;
};

/// Local approximation at the centre of each ball: the projection's foot with its second derivatives. The constructor
/// projects the centres once; balls without a projection have no polynomial.
class StoredPolynomials {
 public:
  /// Finite centres, positive radii, at least one ball.
  StoredPolynomials(const Projection& projection, const BallUnion& balls);
  StoredPolynomials(StoredPolynomials&&) noexcept;
  StoredPolynomials& operator=(StoredPolynomials&&) noexcept;
  ~StoredPolynomials();

  /// The nearest intersection of each ray, between `near` and `far`, with any of the polynomials inside its ball. Does
  /// not depend on the number of threads. Sizes must agree.
  void first(std::span<const CastRay> rays, std::span<StoredHit> hits) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Distance along the ray from x to the surface around the foot: the nearest root of a quadratic. NaN if the surface is
/// not near.
double meet(const FootPoint& foot, const Vec3& x, const Vec3& direction);

/// Each ray starts at its first intersection with a stored polynomial and applies the projection there. If the foot is
/// within `tolerance` (times the ball's radius), the surface is found. Otherwise the ray moves to its intersection with
/// the local approximation at the foot if that is in the same ball, else to the next stored polynomial. Returns the
/// number of projections for rays that hit and for rays that miss.
struct StoredCounts {
  std::uint64_t hit_evaluations = 0, miss_evaluations = 0, queries = 0;
};
StoredCounts cast_from_stored(const Projection& projection, const BallUnion& balls,
                              const StoredPolynomials& polynomials, double tolerance, std::span<const CastRay> rays,
                              std::span<CastHit> hits);

}  // namespace sansmesh::inline v1::detail
