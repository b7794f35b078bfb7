#include "sansmesh/flow/trace.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/flow/flow_integrator.h"
#include "sansmesh/schema/registry_words.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kTolerance = 1e-5;  // over the diagonal
/// Steps that leave the field are halved until they are shorter than this, over the diagonal: the boundary is reached.
constexpr double kAtBoundary = 1e-7;
/// Steps after one that left cover this fraction of the straight distance to the side of the field's box.
constexpr double kNearlyOut = 0.98;
/// Step size control: safety factor and limits of the change.
constexpr double kCaution = 0.9, kMostShrink = 0.2, kMostGrowth = 5;
/// Lines have points between the ends of steps, so that they turn by at most kTurn radians per point and deviate from
/// their chords by at most kSag diagonals, with at most kMostPartsOfStep parts per step. A point closer than kSag to
/// the last but one replaces the last.
constexpr double kTurn = 0.2, kSag = 2e-4, kMostPartsOfStep = 64;
/// After kCircling steps, errors may add up to as many tolerances: a particle still within kCircle tolerances of its
/// earlier position circles about a critical point that it cannot approach further.
constexpr std::uint32_t kCircling = 64;
constexpr double kCircle = 32;
/// Particles per thread batch; amortises its overhead.
constexpr std::size_t kTogether = 128;

/// A particle's step: its ends and the path between them.
struct Step {
  std::uint32_t particle;
  double from, to;                  // moments
  Vec3 start, end, velocity, last;  // positions and field at both ends
  Vec3 bulge;                       // term of highest order; zero if there is none
  Vec3 at(double share) const {
    const double h = to - from, rest = 1 - share;
    const Vec3 d = end - start, b = velocity * h - d;
    return start + (d + (b + (d - last * h - b + bulge * rest) * share) * rest) * share;
  }
};

/// A particle's position some steps ago, and the number of steps.
struct Anchor {
  Vec3 position;
  std::uint32_t steps = 0;
};

/// Limits of particles. Entries are per particle.
struct Limits {
  std::span<const double> until;   // moments
  std::span<const double> length;  // remaining length, if not empty
  std::span<std::uint32_t> tries;  // attempted steps
  std::span<double> gone;          // moments by which they had left the field; infinite if unknown
  std::span<Anchor> anchors;       // if not empty, circling particles count as arrived
};

class Stepper {
 public:
  Stepper(const VectorField& field, const TraceOptions& options)
      : options_(options), integrator_(FlowIntegrator::registry().at(options.integrator)), step_(field) {
    box_ = field.bounds();
    const double diagonal = box_.diagonal();
    tolerance_ = trace_tolerance(field, options);
    reach_ = options.step.value_or(integrator_.reach * diagonal);
    boundary_ = kAtBoundary * diagonal;
    direction_ = options.backward ? -1 : 1;
    times_ = field.times();
  }

  /// Attempts one step of each moving particle; particles that end leave `active`. `made` is called for every completed
  /// step, in the order of the particles.
  void round(Particles& p, std::vector<std::uint32_t>& active, const Limits& limits,
             const std::function<void(const Step&)>& made) {
    ends_.assign(active.size(), {});
    h_.resize(active.size()), to_.resize(active.size());
    for (std::size_t a = 0; a < active.size(); ++a) prepare(p, active[a], limits, a);
    drop_ended(p, active);
    if (!active.empty()) integrator_.step(step_);
    finish(p, active, limits, made);
  }

 private:
  double until(const Limits& limits, std::uint32_t i) const {
    const double t = limits.until[i];
    return options_.backward ? std::max(t, times_.first) : std::min(t, times_.last);
  }

  /// Chooses the next step in time, or ends the particle.
  void prepare(Particles& p, std::uint32_t i, const Limits& limits, std::size_t a) {
    const double last = until(limits, i), left = direction_ * (last - p.times[i]);
    const double speed = norm(p.velocities[i]);
    if (!(left > 0)) {
      ends_[a] = TraceEnd::time;
      return;
    }
    if (!(speed > options_.least_speed)) {
      ends_[a] = TraceEnd::critical_point;
      return;
    }
    if (limits.tries[i]++ >= options_.most_steps) {
      ends_[a] = TraceEnd::steps;
      return;
    }
    double h = reach_ / speed;
    if (p.steps[i] > 0) h = std::min(h, p.steps[i]);
    if (!limits.length.empty()) {
      if (!(limits.length[i] > boundary_)) {
        ends_[a] = TraceEnd::length;
        return;
      }
      h = std::min(h, limits.length[i] / speed);
    }
    if (const double ahead = direction_ * (limits.gone[i] - p.times[i]); ahead > 0 && std::isfinite(ahead)) {
      const double out = time_to_side(p.positions[i], p.velocities[i] * direction_);
      h = std::min(h, std::max(out < ahead ? kNearlyOut * out : 0.5 * ahead, 0.5 * boundary_ / speed));
    }
    // Avoids a tiny last step.
    const bool arrives = h >= left;
    if (!arrives && h > 0.5 * left) h = 0.5 * left;
    h_[a] = direction_ * (arrives ? left : h);
    to_[a] = arrives ? last : p.times[i] + h_[a];
  }

  /// Time until a particle leaves the box of the field on a straight line.
  double time_to_side(const Vec3& x, const Vec3& velocity) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k)
      if (velocity[k] != 0)
        least = std::min(least, ((velocity[k] > 0 ? box_.upper[k] : box_.lower[k]) - x[k]) / velocity[k]);
    return std::max(least, 0.0);
  }

  void drop_ended(Particles& p, std::vector<std::uint32_t>& active) {
    std::size_t left = 0;
    for (std::size_t a = 0; a < active.size(); ++a) {
      if (ends_[a]) {
        p.ends[active[a]] = ends_[a];
        continue;
      }
      active[left] = active[a];
      h_[left] = h_[a], to_[left] = to_[a];
      ++left;
    }
    active.resize(left);
    step_.begin(left);
    for (std::size_t a = 0; a < left; ++a) {
      const std::uint32_t i = active[a];
      step_.put(a, p.positions[i], p.times[i], h_[a], p.velocities[i]);
    }
  }

  /// Whether a particle at x has made no progress for long.
  bool circles(const Vec3& x, Anchor& anchor) const {
    const double near = std::min(kCircle * tolerance_, 0.25 * kCircling * reach_);
    if (squared_norm(x - anchor.position) > near * near) anchor = {x, 0};
    return ++anchor.steps > kCircling;
  }

  void finish(Particles& p, std::vector<std::uint32_t>& active, const Limits& limits,
              const std::function<void(const Step&)>& made) {
    const double power = 1.0 / integrator_.order;
    std::size_t left = 0;
    for (std::size_t a = 0; a < active.size(); ++a) {
      const std::uint32_t i = active[a];
      const double h = std::abs(h_[a]);
      if (step_.has_left(a)) {
        // Halve the next attempt until the boundary is resolved.
        if (h * norm(p.velocities[i]) < boundary_)
          p.ends[i] = TraceEnd::boundary;
        else
          p.steps[i] = 0.5 * h, limits.gone[i] = to_[a], active[left++] = i;
        continue;
      }
      if (integrator_.adaptive) {
        const double error = step_.error(a);
        const double ratio = error > 0 ? kCaution * std::pow(tolerance_ / error, power) : kMostGrowth;
        p.steps[i] = h * std::clamp(ratio, kMostShrink, kMostGrowth);
        if (error > tolerance_) {
          active[left++] = i;
          continue;
        }
      }
      const Step step{
          i, p.times[i], to_[a], p.positions[i], step_.end(a), p.velocities[i], step_.last_velocity(a), step_.bulge(a)};
      // Away from the boundary: lengthen steps again.
      if (!integrator_.adaptive && p.steps[i] > 0) p.steps[i] = 2 * h;
      p.positions[i] = step.end, p.times[i] = step.to, p.velocities[i] = step.last;
      made(step);
      if (integrator_.adaptive && !limits.anchors.empty() && circles(step.end, limits.anchors[i]))
        p.ends[i] = TraceEnd::critical_point;
      else
        active[left++] = i;
    }
    active.resize(left);
  }

  const TraceOptions& options_;
  const FlowIntegrator& integrator_;
  ParticleStep step_;
  TimeRange times_;
  Box3 box_;
  double tolerance_ = 0, reach_ = 0, boundary_ = 0, direction_ = 1;
  std::vector<std::optional<TraceEnd>> ends_;
  std::vector<double> h_, to_;
};

/// The first of the moments after `t`; infinite if there is none.
double moment_beyond(std::span<const double> moments, double t, bool backward) {
  if (backward) {
    const auto found = std::lower_bound(moments.begin(), moments.end(), t);
    return found == moments.begin() ? -std::numeric_limits<double>::infinity() : *(found - 1);
  }
  const auto found = std::upper_bound(moments.begin(), moments.end(), t);
  return found == moments.end() ? std::numeric_limits<double>::infinity() : *found;
}

/// Number of parts into which a step of a line is divided.
int parts_of(const Step& step, double sag) {
  const Vec3 chord = step.end - step.start, middle = step.at(0.5);
  // The angles between its directions at the start, over both halves, and at the end, as chords of the unit circle.
  const std::array<Vec3, 4> ways{normalized(step.velocity), normalized(middle - step.start),
                                 normalized(step.end - middle), normalized(step.last)};
  const double sign = step.to < step.from ? -1 : 1;  // backward, velocities are opposite to steps
  const double turn = norm(ways[1] - ways[0] * sign) + norm(ways[2] - ways[1]) + norm(ways[3] * sign - ways[2]);
  const double parts = std::max(turn / kTurn, std::sqrt(norm(chord) * turn / (8 * sag)));
  return index_in<int>(std::ceil(parts), 1, kMostPartsOfStep);
}

/// Data of traced particles; see Limits.
struct Followed {
  std::vector<double> until, length;
  std::vector<std::uint32_t> tries;
  std::vector<double> gone;
  std::vector<Anchor> anchors;
};

/// Moves particles until each has ended or reached its moment `until`; those already there do not count as ended.
/// Between moments of the field all move together, so that few of its time steps are needed at a time. `made` is called
/// from several threads, for each particle from one.
void follow(const VectorField& field, Particles& p, std::vector<std::uint32_t> active, Followed& with,
            const TraceOptions& options, const std::function<void(const Step&)>& made, Progress* progress) {
  const std::span<const double> moments = field.sample_times(), until = with.until;
  const bool backward = options.backward;
  const auto before = [&](double a, double b) { return backward ? a > b : a < b; };
  std::vector<double> target(p.positions.size());
  with.tries.resize(p.positions.size());
  with.gone.assign(p.positions.size(), std::numeric_limits<double>::infinity());
  const Limits limits{target, with.length, with.tries, with.gone, with.anchors};
  std::vector<std::uint32_t> now, later;
  while (!active.empty()) {
    double first = p.times[active[0]];
    for (const std::uint32_t i : active)
      if (before(p.times[i], first)) first = p.times[i];
    const double next = moment_beyond(moments, first, backward);
    now.clear(), later.clear();
    for (const std::uint32_t i : active) {
      target[i] = before(next, until[i]) ? next : until[i];
      (before(p.times[i], target[i]) || !before(p.times[i], until[i]) ? now : later).push_back(i);
    }
    parallel_ranges(0, now.size(), kTogether, [&](std::size_t begin, std::size_t end) {
      Stepper stepper(field, options);
      std::vector<std::uint32_t> these(now.begin() + static_cast<std::ptrdiff_t>(begin),
                                       now.begin() + static_cast<std::ptrdiff_t>(end));
      while (!these.empty()) {
        stepper.round(p, these, limits, made);
        if (progress) progress->check();
      }
      if (progress && moments.empty()) progress->advance(end - begin);
    });
    const std::size_t all = active.size();
    active = later;
    for (const std::uint32_t i : now) {
      if (p.ends[i] != TraceEnd::time || !before(p.times[i], until[i]) || !field.times().contains(p.times[i])) continue;
      const bool last = backward ? !(p.times[i] > field.times().first) : !(p.times[i] < field.times().last);
      if (last) continue;
      p.ends[i].reset();
      active.push_back(i);
    }
    std::sort(active.begin(), active.end());
    if (progress && !moments.empty()) progress->advance(all - active.size());
  }
}

/// Names of the adaptive or of the other integrators: "euler, rk4".
std::string integrators_that(bool adaptive) {
  std::string names;
  for (const FlowIntegrator* const one : FlowIntegrator::registry().all())
    if (one->adaptive == adaptive) names += (names.empty() ? "" : ", ") + std::string(one->name);
  return names;
}

/// "of the diagonal: euler 0.001, dopri5 0.02"
std::string reach_words() {
  std::string words = "of the diagonal:";
  for (const FlowIntegrator* const one : FlowIntegrator::registry().all())
    words += fmt::format("{} {} {}", words.back() == ':' ? "" : ",", one->name, one->reach);
  return words;
}

}  // namespace

const OptionSchema& TraceOptions::schema() {
  using O = TraceOptions;
  using Words = RegistryWords<FlowIntegrator>;
  static const std::string integrators = "Integrator of particles: " + registry_summaries<FlowIntegrator>(),
                           reaches = reach_words(),
                           steps = "Of " + integrators_that(false) + ", and at most of " + integrators_that(true);
  static const OptionRow rows[] = {
      option<&O::integrator, Words>({.text = integrators, .choices = Words::names()}),
      option<&O::tolerance>({.text = "Accepted error of a step",
                             .unit = "length",
                             .from_data = "1e-5 of the diagonal",
                             .range = positive()}),
      option<&O::step>(
          {.text = steps, .unit = "length", .from_data = reaches, .range = positive(), .name = "step_length"}),
      option<&O::least_speed>({.text = "Speed below which particles end; 0: for lines 1e-6 of the seeds' median",
                               .unit = "speed",
                               .range = at_least(0)}),
      option<&O::most_steps>({.text = "Largest number of steps of a particle", .range = at_least(1)})};
  static const OptionSchema schema{rows};
  return schema;
}

void TraceOptions::validate() const {
  validate_options(*this);
  check_argument(duration > 0, "`duration` must be positive");
  check_argument(length > 0, "`length` must be positive");
}

double trace_tolerance(const VectorField& field, const TraceOptions& options) {
  return options.tolerance.value_or(kTolerance * field.bounds().diagonal());
}

Particles particles_at(const VectorField& field, std::span<const Vec3> seeds, std::span<const double> moments) {
  if (seeds.size() != moments.size()) throw ArgumentError("the numbers of moments and seeds must be equal");
  Particles p;
  p.positions.assign(seeds.begin(), seeds.end());
  p.times.assign(moments.begin(), moments.end());
  p.velocities.resize(seeds.size());
  p.steps.assign(seeds.size(), 0);
  p.ends.assign(seeds.size(), {});
  std::vector<std::uint8_t> inside(seeds.size());
  field.evaluate(p.positions, p.times, p.velocities, inside);
  for (std::size_t i = 0; i < seeds.size(); ++i)
    if (inside[i] == 0) p.ends[i] = TraceEnd::outside;
  return p;
}

void move_particles(const VectorField& field, Particles& particles, std::span<const std::uint32_t> which, double time,
                    const TraceOptions& options) {
  options.validate();
  std::vector<std::uint32_t> active;
  for (const std::uint32_t i : which)
    if (!particles.ends[i]) active.push_back(i);
  Followed with;
  with.until.assign(particles.positions.size(), time);
  follow(
      field, particles, active, with, options, [](const Step&) {}, nullptr);
  for (const std::uint32_t i : active)
    if (particles.ends[i] == TraceEnd::time && particles.times[i] == time) particles.ends[i].reset();
}

Traces trace_lines(const VectorField& field, std::span<const Vec3> seeds, std::span<const double> moments,
                   const TraceOptions& options, Progress& progress) {
  options.validate();
  const std::size_t n = seeds.size();
  Particles p = particles_at(field, seeds, moments);
  struct Line {
    std::vector<Vec3> positions;
    std::vector<double> times;
    std::vector<Vec3> velocities;
    void add(const Vec3& x, double t, const Vec3& v, double near) {
      const std::size_t n = positions.size();
      if (n > 1 && squared_norm(x - positions[n - 2]) < near * near)
        positions.pop_back(), times.pop_back(), velocities.pop_back();
      positions.push_back(x), times.push_back(t), velocities.push_back(v);
    }
  };
  std::vector<Line> lines(n);
  std::vector<std::uint32_t> active;
  Followed with;
  with.until.resize(n);
  if (std::isfinite(options.length)) with.length.assign(n, options.length);
  // In unsteady flows steps end at each moment, even if the flow is slow, so they indicate nothing.
  if (options.least_speed > 0 && field.sample_times().empty()) with.anchors.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    with.until[i] = moments[i] + (options.backward ? -options.duration : options.duration);
    if (p.ends[i]) continue;
    active.push_back(static_cast<std::uint32_t>(i));
    lines[i] = {{p.positions[i]}, {p.times[i]}, {p.velocities[i]}};
    if (!with.anchors.empty()) with.anchors[i].position = p.positions[i];
  }
  const double sag = kSag * field.bounds().diagonal();
  const auto keep = [&](const Step& step) {
    Line& line = lines[step.particle];
    const int parts = parts_of(step, sag);
    Vec3 last = step.start;
    for (int k = 1; k <= parts; ++k) {
      const double share = static_cast<double>(k) / parts;
      const Vec3 x = k == parts ? step.end : step.at(share);
      if (!with.length.empty()) with.length[step.particle] -= norm(x - last);
      last = x;
      line.add(x, k == parts ? step.to : step.from + share * (step.to - step.from),
               step.velocity + (step.last - step.velocity) * share, sag);
    }
  };
  progress.begin("trace", n);
  follow(field, p, active, with, options, keep, &progress);

  Traces traces;
  std::size_t points = 0;
  for (const Line& line : lines) points += line.positions.size();
  traces.positions.reserve(points), traces.times.reserve(points), traces.velocities.reserve(points);
  traces.offsets.reserve(n + 1), traces.ends.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Line line = std::move(lines[i]);  // frees its memory
    traces.positions.insert(traces.positions.end(), line.positions.begin(), line.positions.end());
    traces.times.insert(traces.times.end(), line.times.begin(), line.times.end());
    traces.velocities.insert(traces.velocities.end(), line.velocities.begin(), line.velocities.end());
    traces.offsets.push_back(traces.positions.size());
    traces.ends.push_back(p.ends[i].value_or(TraceEnd::steps));
  }
  progress.finish();
  return traces;
}

}  // namespace sansmesh::inline v1
