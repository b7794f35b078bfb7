// Segments of rays inside a union of balls (Embree).
#pragma once

#include <memory>
#include <span>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct SegmentQuery {
  Vec3f origin, direction;  ///< unit direction
  float from = 0, far = 0;  ///< along the ray
};

/// The part of a ray inside one ball.
struct BallSegment {
  bool found = false;
  float entry = 0, exit = 0;  ///< entry: at least `from` of the query; exit: may be beyond `far`
  float radius = 0;
};

/// Built once; queries are thread-safe.
class BallSegments {
 public:
  /// Finite centres, positive radii, at least one ball.
  explicit BallSegments(const BallUnion& balls);
  BallSegments(BallSegments&&) noexcept;
  BallSegments& operator=(BallSegments&&) noexcept;
  ~BallSegments();

  /// For each query the ball that contains the ray at `from`, or else the first ball that it enters up to `far`. If
  /// several balls contain the ray at `from`, the one that it leaves last. Balls that it leaves within `slack` of
  /// `from` do not count, so that a query from the end of a ball continues to the next. Fastest if neighbouring rays
  /// are adjacent. Does not depend on the number of threads. Sizes must agree.
  void first(std::span<const SegmentQuery> queries, std::span<BallSegment> segments) const;

  /// Negligible length along the ray.
  static float slack(float distance, float radius) { return kSlackOfRadius * radius + kSlackOfDistance * distance; }
  static constexpr float kSlackOfRadius = 1e-4f, kSlackOfDistance = 1e-6f;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
