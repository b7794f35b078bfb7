// Root search of one ray: the next position to evaluate, given the samples so far. Independent of the field.
#pragma once

#include <limits>

#include "sansmesh/render/surface/ball_segments.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Parameters common to all rays of a caster, as shares of the radius of the local ball.
struct WalkRules {
  double tolerance = 1e-3, smallest_step = 0.1, largest_step = 0.5, jump = 0.01;
  bool projected = false;  ///< samples come from a projection
};

/// Sample of the surface at a position of the ray.
struct WalkSample {
  bool inside = false;  ///< inside the domain of definition
  double value = 0;     ///< approximate signed distance
  /// Predicted distance to the surface along the ray; NaN if there is no prediction.
  double root = std::numeric_limits<double>::quiet_NaN();
  double slant = 1;      ///< |cosine| between ray and normal, with `root`
  double steepness = 1;  ///< length of the gradient, with `root`
  double residual = 0;   ///< projections: distance to the foot
  Vec3f normal;
};

/// State of one ray: it marches from ball to ball and jumps to the predicted surface. After a change of sign it
/// brackets the root. Where the distance decreases and increases again, it searches for a double root in between.
class RayWalk {
 public:
  enum class Request {
    segment,  ///< the next ball from `end()` on: enter()
    value,    ///< the field at `at()`: take()
    root,     ///< the same, with the gradient
    nothing   ///< done
  };

  RayWalk() = default;
  RayWalk(float near, float far) : end_(near), far_(far) {}

  Request request() const { return request_; }
  double at() const { return at_; }
  double end() const { return end_; }
  double far() const { return far_; }
  bool hit() const { return hit_; }
  double distance() const { return at_; }  ///< distance of the hit
  const Vec3f& normal() const { return normal_; }
  double radius() const { return radius_; }
  int evaluations() const { return evaluations_; }

  void enter(const BallSegment& segment, const WalkRules& rules);
  void take(const WalkSample& sample, const WalkRules& rules);

 private:
  struct RaySample {
    double t = 0, value = 0;
  };
  enum class Phase { march, bracket, dip };

  void begin(const BallSegment& segment);
  void leave();
  void finish(bool hit);
  void go_to(double t, const WalkRules& rules, Request request);
  void stop_at(double t, const WalkRules& rules, const BallSegment& following);
  void march_on(const WalkSample& sample, const WalkRules& rules);
  void step_outside(const WalkSample& sample, const WalkRules& rules);
  bool accept(const WalkSample& sample, const WalkRules& rules) const;
  bool look_into_dip(const RaySample& now, const WalkRules& rules);
  void close_in(const WalkSample& sample, const WalkRules& rules);
  void narrow(const WalkSample& sample, const WalkRules& rules);
  void go_on_from(const RaySample& sample, const WalkRules& rules);

  double at_ = 0, end_ = 0, far_ = 0, radius_ = 0;
  double next_ = 0;  // next position once the ball behind end_ is known
  Request request_ = Request::segment, next_request_ = Request::value;
  Phase phase_ = Phase::march;
  bool walking_ = false;   // end_ is the end of a ball that contains the ray
  bool at_start_ = false;  // the ray starts here, inside a ball
  bool leaving_ = false;   // the last sample before a gap between the balls
  bool hit_ = false;
  BallSegment following_;   // behind that gap
  int known_ = 0;           // number of valid values among low_ and before_ in one stretch inside the domain
  RaySample low_, before_;  // the last sample and the one before it
  RaySample high_;          // other side of the surface, or the position to continue from after a dip
  double residual_ = 0;     // residual of the previous sample, if it was aimed at this one; else 0
  double outside_value_ = 0;
  double outside_ = 0;       // the last position outside of the domain
  double inside_again_ = 0;  // a position beyond it that is inside
  bool from_outside_ = false;
  bool beyond_ = false;  // the last sample in the bracket
  int rim_ = 0, aims_ = 0, rounds_ = 0;
  int evaluations_ = 0;
  Vec3f normal_;
};

}  // namespace sansmesh::inline v1
