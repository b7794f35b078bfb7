#include "sansmesh/flow/flow_fronts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/median.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Largest ratio of the time steps of successive fronts.
constexpr double kChange = 2;
/// Fronts are closer together than at median speed by at most this factor, where some particles are fast.
constexpr double kMostParts = 256;
/// In mixing flows, insertion never ends, and each inserted particle is traced from its seed: the surface ends after
/// this many particle moves per allowed point.
constexpr double kMostWork = 10;
/// A step that moves a particle farther than α Δ₀ is repeated with this fraction of the length that would suffice at
/// constant speed.
constexpr double kShorter = 0.9, kShortEnough = 0.99;

}  // namespace

FlowFronts::FlowFronts(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options)
    : field_(field), curve_(curve), options_(options), trace_(options.trace), start_(*options.start) {
  length_ = curve.length();
  spacing_ = length_ / static_cast<double>(curve.closed ? *options.seeds : *options.seeds - 1);
  least_span_ = least_seed_distance(field, options.trace);
  sheet_.report.spacing = spacing_;
  seed();
}

void FlowFronts::run(bool backward, Progress& progress) {
  trace_.backward = backward;
  particles_ = seeds_, members_ = first_, names_.clear(), moments_.clear(), ahead_ = {};
  for (std::size_t i = 0; i < *options_.seeds; ++i) names_.push_back(static_cast<std::uint32_t>(i));
  const TimeRange times = field_.times();
  const double sign = backward ? -1 : 1;
  const double left_in_field = backward ? start_ - times.first : times.last - start_;
  const double duration = std::min(*options_.duration, left_in_field);
  const double end = start_ + sign * duration;
  const double most_way = options_.length.value_or(std::numeric_limits<double>::infinity());
  double t = start_, step = 0;
  way_ = 0, most_way_ = most_way;
  progress.begin(backward ? "fronts backward" : "fronts", options_.most_fronts);
  for (front_ = 1; !members_.empty() && t != end && way_ < most_way; ++front_) {
    if (front_ > options_.most_fronts || sheet_.points.size() >= options_.most_points ||
        work_ >= kMostWork * static_cast<double>(options_.most_points)) {
      sheet_.report.complete = false;
      break;
    }
    step = next_step(step);
    share_ = options_.front_step ? 1 : std::clamp(kShorter * longest_way() / (fastest() * step), 1 / kMostParts, 1.0);
    // Equal steps to the end, without a tiny last one.
    const double left = std::abs(end - t), steps = std::ceil(left / (share_ * step) * (1 - 1e-9));
    const double to = steps <= 1 ? end : t + sign * (std::isfinite(left) ? left / steps : share_ * step);
    // Moments may be too close to differ.
    const double next = to == t ? t : advance(t, to, step, end);
    if (next == t) {
      sheet_.report.complete = false, sheet_.report.moments_meet = true;
      break;
    }
    t = next;
    progress.advance();
  }
  for (const auto& e : particles_.ends)
    if (e && *e != TraceEnd::outside) ++sheet_.report.ends[static_cast<std::size_t>(*e)];
  progress.finish();
}

void FlowFronts::seed() {
  const std::size_t n = *options_.seeds;
  std::vector<double> s(n);
  for (std::size_t i = 0; i < n; ++i) s[i] = std::min(spacing_ * static_cast<double>(i), length_);
  particles_ = particles_at(field_, curve_.at(s), std::vector<double>(n, start_));
  sheet_.report.particles = n, sheet_.report.fronts = 1;
  next_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    FrontMember& m = next_[i];
    m.particle = static_cast<std::uint32_t>(i), m.s = s[i], m.was = particles_.positions[i];
    names_.push_back(m.particle);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = i + 1 < n ? i + 1 : 0;
    next_[i].joined = (j > 0 || curve_.closed) && !ended(next_[i]) && !ended(next_[j]);
  }
  for (const std::uint32_t i : blocked(start_)) next_[i].joined = false;
  front_ = 0;
  make_points(false);
  keep_continuing();
  first_ = members_, seeds_ = particles_;
  for (const auto& e : particles_.ends)
    if (e) ++sheet_.report.ends[static_cast<std::size_t>(*e)];
  if (members_.empty()) throw DataError("no part of the seed curve is in the flow");
}

double FlowFronts::next_step(double last) const {
  if (options_.front_step) return *options_.front_step;
  std::vector<double> speeds;
  speeds.reserve(members_.size());
  for (const FrontMember& m : members_) speeds.push_back(norm(particles_.velocities[m.particle]));
  if (last == 0) return front_time(std::move(speeds), spacing_);
  return std::clamp(spacing_ / median(speeds), last / kChange, last * kChange);
}

double FlowFronts::fastest() const {
  double most = 0;
  for (const FrontMember& m : members_)
    if (!ended(m)) most = std::max(most, norm(particles_.velocities[m.particle]));
  return most;
}

double FlowFronts::advance(double from, double to, double step, double end) {
  std::vector<std::uint32_t> which;
  which.reserve(members_.size());
  for (const FrontMember& m : members_) which.push_back(m.particle);
  next_ = members_;
  for (std::size_t i = 0; i < next_.size(); ++i) {
    next_[i].was = place(next_[i]);
    next_[i].before = static_cast<std::uint32_t>(i);
  }
  to = move_members(which, from, to, step);
  ahead_.move(field_, to, trace_);
  moments_.push_back(from);
  inserted_ = 0;
  fill_gaps(from, to);
  pass_obstacles(from, to);
  drop_parted_insertions();
  remove_needless();
  ++sheet_.report.fronts;
  sheet_.report.inserted += inserted_;
  way_ += median_step();
  const bool last = to == end || !(way_ < most_way_) || front_ == options_.most_fronts;
  const bool moved = make_points(last);
  make_triangles();
  keep_continuing();
  if (!moved) members_.clear();
  return to;
}

double FlowFronts::move_members(const std::vector<std::uint32_t>& which, double from, double to, double step) {
  const bool free = !options_.front_step;
  Particles before;
  if (free) before = particles_;
  for (;;) {
    move_particles(field_, particles_, which, to, trace_);
    work_ += static_cast<double>(which.size());
    double most = 0;
    for (const FrontMember& m : next_) most = std::max(most, norm(place(m) - m.was));
    const double went = std::abs(to - from), least = step / kMostParts;
    if (!free || !(most > longest_way())) return to;
    const double next = std::max(least, went * std::max(kShorter * longest_way() / most, 1.0 / 8));
    if (next > kShortEnough * went) return to;  // rounding may keep `went` above the least forever
    particles_ = before;
    to = to > from ? from + next : from - next;
    share_ = std::min(share_, next / step);
  }
}

double FlowFronts::median_step() const {
  std::vector<double> steps;
  steps.reserve(next_.size());
  for (const FrontMember& m : next_)
    if (const double step = norm(place(m) - m.was); step > kAtRest * share_ * spacing_) steps.push_back(step);
  return median(steps);
}

FlowSheet advance_fronts(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options,
                         Progress& progress) {
  FlowFronts fronts(field, curve, options);
  if (options.direction != FlowDirection::backward) fronts.run(false, progress);
  if (options.direction != FlowDirection::forward) fronts.run(true, progress);
  return fronts.take();
}

}  // namespace sansmesh::inline v1
