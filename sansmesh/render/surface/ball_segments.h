// Where rays run inside a union of balls (Embree).
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct SegmentQuery {
  Vec3f origin, direction;  ///< direction: unit vector
  float from = 0, far = 0;  ///< along the ray
};

/// The part of a ray inside one ball.
struct BallSegment {
  bool found = false;
  float entry = 0, exit = 0;  ///< entry: at least `from` of the query; exit: may lie beyond `far`
  float radius = 0;
};

/// Built once, then asked from any thread.
class BallSegments {
 public:
  /// Finite centres, positive radii, at least one.
  explicit BallSegments(const BallUnion& balls);
  BallSegments(BallSegments&&) noexcept;
  BallSegments& operator=(BallSegments&&) noexcept;
  ~BallSegments();

  /// For each query the ball that the ray is in or enters first from `from` on, up to `far`; of several balls that hold
  /// the place `from` the one that it leaves last. Balls that it leaves right there (`slack`) do not count: asking
  /// again from where a ball ends goes on to the next one. Neighbouring rays in neighbouring slots go fastest. The
  /// answer does not depend on the number of threads. Sizes must agree.
  void first(std::span<const SegmentQuery> queries, std::span<BallSegment> segments) const;

  /// Length along the ray that counts as nothing.
  static float slack(float distance, float radius) { return kSlackOfRadius * radius + kSlackOfDistance * distance; }
  static constexpr float kSlackOfRadius = 1e-4f, kSlackOfDistance = 1e-6f;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
