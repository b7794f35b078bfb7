// Rays that start from polynomials stored with the samples (METHODS §4; tejada2008 §4.5.1, after Adamson & Alexa 2003).
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/projection.h"
#include "sansmesh/render/scene/cast_ray.h"

namespace sansmesh::inline v1::detail {

/// Where a ray meets the polynomial of a ball inside it.
struct StoredHit {
  bool found = false;
  float distance = 0;  ///< along the ray
  std::uint32_t ball = 0;
};

/// The local approximation at the centre of each ball: the projection's foot there with its second derivatives. A
/// projection is applied to the centres once; where it is undefined a ball has none.
class StoredPolynomials {
 public:
  /// Finite centres, positive radii, at least one.
  StoredPolynomials(const Projection& projection, const BallUnion& balls);
  StoredPolynomials(StoredPolynomials&&) noexcept;
  StoredPolynomials& operator=(StoredPolynomials&&) noexcept;
  ~StoredPolynomials();

  /// The nearest meeting of each ray, between `near` and `far`, with any of the polynomials inside its ball. Does not
  /// depend on the number of threads. Sizes must agree.
  void first(std::span<const CastRay> rays, std::span<StoredHit> hits) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Where the ray, at x, meets the surface around the foot, as a way along the ray: the nearest root of a quadratic. Not
/// a number: nowhere near.
double meet(const FootPoint& foot, const Vec3& x, const Vec3& direction);

/// Each ray begins where it first meets a stored polynomial. There the operator is applied: if the foot is within
/// `tolerance` (of the ball's radius) the surface is found; else the ray goes to where it meets the local approximation
/// at the foot, as long as that is in the same ball; else to the next stored polynomial. Returns the number of
/// projections for rays that hit, and for those that do not.
struct StoredCounts {
  std::uint64_t hit_evaluations = 0, miss_evaluations = 0, queries = 0;
};
StoredCounts cast_from_stored(const Projection& projection, const BallUnion& balls,
                              const StoredPolynomials& polynomials, double tolerance, std::span<const CastRay> rays,
                              std::span<CastHit> hits);

}  // namespace sansmesh::inline v1::detail
