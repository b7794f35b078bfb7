#include "sansmesh/render/surface/ray_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sansmesh::inline v1 {
namespace {

constexpr int kAims = 8;                // predicted jumps per ball
constexpr int kRimSteps = 3;            // bisections towards the rim of the domain
constexpr int kQuickRounds = 5;         // in a bracket, before bisection
constexpr int kMostEvaluations = 5000;  // far more than any ray needs; a bound for irregular fields
constexpr double kOutsideStep = 0.25;   // least step, as a share of the ball's radius
constexpr double kAimReach = 3;         // length limit of a jump, in largest steps
constexpr double kAimSlant = 4;         // and in distances to the surface
constexpr double kBeyond = 4;           // radii: larger values outside of the domain are not distances
constexpr double kTrust = 1.2;          // no surface is closer than the field's value over this

bool opposite(double a, double b) { return (a < 0) != (b < 0); }

}  // namespace

void RayWalk::finish(bool hit) {
  hit_ = hit;
  request_ = Request::nothing;
}

void RayWalk::begin(const BallSegment& segment) {
  if (!segment.found || !(segment.entry < far_)) return finish(false);
  at_start_ = !walking_ && segment.entry <= end_;
  walking_ = true;
  radius_ = segment.radius;
  // Just inside: the domain of the field may be the same balls.
  const double margin = 0.5 * BallSegments::slack(segment.entry, segment.radius);
  at_ = at_start_ ? segment.entry : segment.entry + margin;
  end_ = std::min(far_, segment.exit - margin);
  known_ = rim_ = aims_ = 0;
  from_outside_ = leaving_ = false;
  phase_ = Phase::march;
  residual_ = 0;
  request_ = Request::root;
}

void RayWalk::leave() { begin(following_); }

void RayWalk::enter(const BallSegment& segment, const WalkRules& rules) {
  if (!walking_) return begin(segment);
  const double gap = BallSegments::slack(static_cast<float>(end_), static_cast<float>(radius_));
  if (!segment.found || segment.entry > end_ + 2 * gap) return stop_at(end_, rules, segment);
  end_ = std::max(end_ + 0.1 * gap, std::min(far_, segment.exit - 0.5 * gap));
  radius_ = segment.radius;
  go_to(next_, rules, next_request_);
}

/// Stops at the last sample before a gap, unless the surface is too far away to matter.
void RayWalk::stop_at(double t, const WalkRules& rules, const BallSegment& following) {
  following_ = following;
  const double left = t - low_.t;
  if (known_ == 0 || left < rules.tolerance * radius_ || std::abs(low_.value) > kTrust * left) return leave();
  leaving_ = true;
  at_ = t;
  request_ = Request::value;
}

void RayWalk::go_to(double t, const WalkRules& rules, Request request) {
  if (t <= end_) {
    at_ = t;
    request_ = request;
  } else if (end_ >= far_) {
    stop_at(far_, rules, {});
  } else {
    next_ = t;
    next_request_ = request;
    request_ = Request::segment;
  }
}

void RayWalk::take(const WalkSample& sample, const WalkRules& rules) {
  if (++evaluations_ > kMostEvaluations) return finish(false);
  const bool start = at_start_;
  at_start_ = false;
  if (!sample.inside || !std::isfinite(sample.value)) {
    // A change of sign across a hole is not a crossing.
    if (phase_ != Phase::march) return go_on_from(high_, rules);
    return step_outside(sample, rules);
  }
  if (!start && accept(sample, rules)) {
    // At grazing angles the root predicted by a foot is far from the surface.
    if (std::abs(sample.root) <= 0.05 * radius_ && at_ + sample.root <= end_) at_ += sample.root;
    normal_ = sample.normal;
    return finish(true);
  }
  residual_ = sample.residual;
  if (phase_ == Phase::bracket) return narrow(sample, rules);
  const RaySample now{at_, sample.value};
  if (phase_ == Phase::dip) {
    const RaySample& left = now.t > low_.t ? low_ : before_;
    if (!opposite(now.value, left.value)) return go_on_from(high_, rules);
    low_ = left;
    high_ = now;
    rounds_ = 0;
    phase_ = Phase::bracket;
    return close_in(sample, rules);
  }
  if (from_outside_) {
    // Searches for the surface between the rim of the domain and this sample.
    const bool other_side = std::abs(outside_value_) > kBeyond * radius_ || opposite(outside_value_, now.value);
    if (rim_ < kRimSteps && other_side && std::abs(now.value) < now.t - outside_) {
      ++rim_;
      inside_again_ = now.t;
      at_ = 0.5 * (outside_ + now.t);
      request_ = Request::value;
      return;
    }
    from_outside_ = false;
    rim_ = 0;
  }
  if (known_ > 0 && opposite(now.value, low_.value)) {
    high_ = now;
    rounds_ = 0;
    phase_ = Phase::bracket;
    return close_in(sample, rules);
  }
  if (known_ > 1 && look_into_dip(now, rules)) return;
  if (known_ > 0) before_ = low_;
  low_ = now;
  known_ = std::min(known_ + 1, 2);
  if (leaving_) return leave();
  march_on(sample, rules);
}

/// Whether the sample shows that the surface is here.
bool RayWalk::accept(const WalkSample& sample, const WalkRules& rules) const {
  const double tolerance = rules.tolerance * radius_;
  if (rules.projected) {
    // Each jump leaves a share of the last residual; the prediction for the next one saves an evaluation.
    if (sample.residual <= tolerance) return true;
    const double share = std::max(0.1, sample.residual / residual_);
    return sample.residual * share <= 0.5 * tolerance && std::abs(sample.root) <= 40 * tolerance;
  }
  if (!(std::abs(sample.root) <= radius_)) return false;
  const double root = at_ + sample.root;
  if (root > end_) return false;
  if (known_ > 0 && !(root > low_.t)) return false;
  if (phase_ == Phase::bracket ? !(root < high_.t) : known_ == 0) return false;
  // The error of a Newton step is within the square of its length, over the radius of curvature.
  return std::abs(sample.root) <= std::max(tolerance, 0.3 * std::sqrt(rules.tolerance) * radius_ * sample.slant) &&
         sample.slant > 0.02;
}

void RayWalk::march_on(const WalkSample& sample, const WalkRules& rules) {
  // Where the gradient is small, the distance exceeds the value.
  const double distance = std::abs(sample.value) / std::clamp(sample.steepness, 0.4, 1.0);
  const double step = std::clamp(distance, rules.smallest_step * radius_, rules.largest_step * radius_);
  const double root = sample.root;
  const double reach = std::max(step, std::min(kAimReach * rules.largest_step * radius_, kAimSlant * distance));
  if (aims_ < kAims && std::abs(root) <= reach) {
    if (root > 0) {
      ++aims_;
      return go_to(low_.t + root, rules, Request::root);
    }
    if (rules.projected && known_ > 1 && low_.t + root > before_.t) {  // a jump may have passed it
      ++aims_;
      high_ = low_;
      at_ = low_.t + root;
      low_ = before_;
      phase_ = Phase::dip;
      request_ = Request::value;
      return;
    }
  }
  residual_ = 0;
  go_to(low_.t + step, rules, Request::root);
}

void RayWalk::step_outside(const WalkSample& sample, const WalkRules& rules) {
  if (leaving_) return leave();
  if (known_ > 0 && rim_ < kRimSteps && std::abs(low_.value) < at_ - low_.t) {
    ++rim_;
    at_ = 0.5 * (low_.t + at_);
    request_ = Request::value;
    return;
  }
  // Values beyond the domain are unreliable, except for the step length.
  const double value = std::abs(sample.value), least = kOutsideStep * radius_;
  const double step = value < kBeyond * radius_ ? std::clamp(0.7 * value, least, radius_) : least;
  const double ahead = from_outside_ && inside_again_ > at_ ? inside_again_ : at_ + step;
  if (known_ > 0) rim_ = 0;
  known_ = 0;
  from_outside_ = true;
  outside_ = at_;
  outside_value_ = std::isfinite(sample.value) ? sample.value : std::numeric_limits<double>::max();
  inside_again_ = 0;
  residual_ = 0;
  go_to(ahead, rules, Request::root);
}

/// Of three samples on the same side with the middle one nearest: whether a parabola through them reaches the surface.
bool RayWalk::look_into_dip(const RaySample& now, const WalkRules& rules) {
  const double a = std::abs(before_.value), b = std::abs(low_.value), c = std::abs(now.value);
  const double left = low_.t - before_.t, right = now.t - low_.t;
  const double fall = (b - a) / left, rise = (c - b) / right, bend = (rise - fall) / (left + right);
  if (!(bend > 0)) return false;
  // |value| = a + fall s + bend s (s − left), s from before_.
  const double s = 0.5 * (left - fall / bend);
  if (!(s > 0 && s < left + right) || a + s * (fall + bend * (s - left)) > rules.tolerance * radius_) return false;
  const double tolerance = rules.tolerance * radius_;
  if (std::abs(s - left) < tolerance || s < tolerance || left + right - s < tolerance) return false;
  high_ = now;
  at_ = before_.t + s;
  phase_ = Phase::dip;
  request_ = Request::value;
  return true;
}

/// Continues as if the sample there had found nothing.
void RayWalk::go_on_from(const RaySample& sample, const WalkRules& rules) {
  phase_ = Phase::march;
  low_ = sample;
  known_ = 1;
  if (leaving_) return leave();
  const double step = std::clamp(std::abs(sample.value), rules.smallest_step * radius_, rules.largest_step * radius_);
  go_to(sample.t + step, rules, Request::root);
}

/// The sample is one end of the bracket [low_, high_]; chooses the next position.
void RayWalk::close_in(const WalkSample& sample, const WalkRules& rules) {
  const double width = high_.t - low_.t, guard = 0.25 * std::min(rules.tolerance * radius_, width);
  const double middle = 0.5 * (low_.t + high_.t);
  const double aimed = at_ + sample.root;
  const bool quick = ++rounds_ <= kQuickRounds, trusted = quick && aimed > low_.t && aimed < high_.t;
  if (rounds_ > 80 || !(middle > low_.t && middle < high_.t)) return go_on_from(high_, rules);
  const double t = trusted ? aimed : quick ? low_.t + width * low_.value / (low_.value - high_.value) : middle;
  if (!trusted) residual_ = 0;
  at_ = std::clamp(t, low_.t + guard, high_.t - guard);
  request_ = Request::root;
}

void RayWalk::narrow(const WalkSample& sample, const WalkRules& rules) {
  // Illinois rule: the end that stays twice has half the weight, so that the next secant lands beyond the root.
  const bool beyond = opposite(sample.value, low_.value);
  if (rounds_ > 1 && beyond == beyond_) (beyond ? low_ : high_).value *= 0.5;
  (beyond ? high_ : low_) = {at_, sample.value};
  beyond_ = beyond;
  const double tolerance = rules.tolerance * radius_;
  if (high_.t - low_.t <= tolerance) {
    // A long jump from one side to the other without a zero is not a surface, nor is a point that the projection moves.
    const double off = rules.projected ? sample.residual : std::abs(sample.value);
    if (off > std::max(10 * tolerance, rules.projected ? 0 : rules.jump * radius_)) return go_on_from(high_, rules);
    normal_ = sample.normal;
    return finish(true);
  }
  close_in(sample, rules);
}

}  // namespace sansmesh::inline v1
