#include "sansmesh/flow/flow_fronts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "sansmesh/core/median.h"
#include "sansmesh/error.h"
#include "sansmesh/flow/flow_integrator.h"
#include "sansmesh/flow/particles_ahead.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};
/// Cosine of the angle between the directions to both neighbours above which a particle is collinear with them (10°).
constexpr double kStraight = 0.985;
/// Particles that moved less than this, over Δ₀, since their last point keep it; particles closer to each other than
/// this count as one.
constexpr double kAtRest = 1e-3;
/// Where one neighbour has ended, the other continues beside a rim, which is resolved to this fraction of Δ₀ on the
/// seed curve.
constexpr double kRim = 1.0 / 64;
/// Gaps across a region without flow are filled until they are this narrow, over Δ₀: the surface then passes beside a
/// round obstacle.
constexpr double kObstacle = 1.0 / 8;
/// Gaps wider than this fraction of the widest may need a particle soon, before those filled now are halved again.
constexpr double kAhead = 1.0 / 4;
/// Largest ratio of the time steps of successive fronts.
constexpr double kChange = 2;
/// Where some particles are so fast that fronts are closer together than at median speed: particles that moved less
/// than kSlow Δ₀ since their last point keep it; fronts are closer by at most the factor kMostParts.
constexpr double kSlow = 0.5, kMostParts = 256;
/// Particles with starts closer than this, in tolerances of the integrator, have none inserted between them. They make
/// nearly the same steps and nearly the same errors, so their separation is known far better than the tolerance.
constexpr double kTooNear = 0.2;
/// In mixing flows, insertion never ends, and each inserted particle is traced from its seed: the surface ends after
/// this many particle moves per allowed point.
constexpr double kMostWork = 10;
/// Tracing fewer particles than this from their seeds takes no less time.
constexpr std::size_t kLeastPass = 16;
/// A step that moves a particle farther than α Δ₀ is repeated with this fraction of the length that would suffice at
/// constant speed.
constexpr double kShorter = 0.9, kShortEnough = 0.99;

/// A particle of a front, between its neighbours.
struct Member {
  std::uint32_t particle = 0;
  std::uint32_t point = kNone;   // its last point
  std::uint32_t before = kNone;  // index in the previous front; none: inserted since
  double s = 0;
  Vec3 was;             // position at the previous front
  bool joined = false;  // with the next member; the last one with the first
  bool removed = false;
  bool needed = false;  // inserted beside an obstacle: not removed
};

class Fronts {
 public:
  Fronts(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options)
      : field_(field), curve_(curve), options_(options), trace_(options.trace), start_(*options.start) {
    length_ = curve.length();
    spacing_ = length_ / static_cast<double>(curve.closed ? *options.seeds : *options.seeds - 1);
    least_span_ = least_seed_distance(field, options.trace);
    sheet_.report.spacing = spacing_;
    seed();
  }

  void run(bool backward, Progress& progress) {
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

  FlowSheet take() { return std::move(sheet_); }

 private:
  const Vec3& place(const Member& m) const { return particles_.positions[m.particle]; }
  bool ended(const Member& m) const { return particles_.ends[m.particle].has_value(); }
  bool at_rim(const Member& a, const Member& b) const { return ended(a) || ended(b); }
  bool full() const { return sheet_.points.size() + next_.size() >= options_.most_points; }

  void seed() {
    const std::size_t n = *options_.seeds;
    std::vector<double> s(n);
    for (std::size_t i = 0; i < n; ++i) s[i] = std::min(spacing_ * static_cast<double>(i), length_);
    particles_ = particles_at(field_, curve_.at(s), std::vector<double>(n, start_));
    sheet_.report.particles = n, sheet_.report.fronts = 1;
    next_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      Member& m = next_[i];
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
    keep_those_that_go_on();
    first_ = members_, seeds_ = particles_;
    for (const auto& e : particles_.ends)
      if (e) ++sheet_.report.ends[static_cast<std::size_t>(*e)];
    if (members_.empty()) throw DataError("no part of the seed curve is in the flow");
  }

  double next_step(double last) const {
    if (options_.front_step) return *options_.front_step;
    std::vector<double> speeds;
    speeds.reserve(members_.size());
    for (const Member& m : members_) speeds.push_back(norm(particles_.velocities[m.particle]));
    if (last == 0) return front_time(std::move(speeds), spacing_);
    const auto middle = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2);
    std::nth_element(speeds.begin(), middle, speeds.end());
    return std::clamp(spacing_ / *middle, last / kChange, last * kChange);
  }

  /// Largest distance of a particle from one front to the next.
  double longest_way() const { return options_.alpha * spacing_; }

  double fastest() const {
    double most = 0;
    for (const Member& m : members_)
      if (!ended(m)) most = std::max(most, norm(particles_.velocities[m.particle]));
    return most;
  }

  /// Advances to a front at `to`, or earlier where particles became fast on the way. `step` is the time between fronts
  /// at median speed, `end` the last moment. Returns the moment of the front.
  double advance(double from, double to, double step, double end) {
    std::vector<std::uint32_t> which;
    which.reserve(members_.size());
    for (const Member& m : members_) which.push_back(m.particle);
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
    keep_those_that_go_on();
    if (!moved) members_.clear();
    return to;
  }

  /// Moves the members at most so far that none exceeds the largest distance.
  double move_members(const std::vector<std::uint32_t>& which, double from, double to, double step) {
    const bool free = !options_.front_step;
    Particles before;
    if (free) before = particles_;
    for (;;) {
      move_particles(field_, particles_, which, to, trace_);
      work_ += static_cast<double>(which.size());
      double most = 0;
      for (const Member& m : next_) most = std::max(most, norm(place(m) - m.was));
      const double went = std::abs(to - from), least = step / kMostParts;
      if (!free || !(most > longest_way())) return to;
      const double next = std::max(least, went * std::max(kShorter * longest_way() / most, 1.0 / 8));
      if (next > kShortEnough * went) return to;  // rounding may keep `went` above the least forever
      particles_ = before;
      to = to > from ? from + next : from - next;
      share_ = std::min(share_, next / step);
    }
  }

  /// Median distance moved since the previous front, of the particles that moved.
  double median_step() const {
    std::vector<double> steps;
    steps.reserve(next_.size());
    for (const Member& m : next_)
      if (const double step = norm(place(m) - m.was); step > kAtRest * share_ * spacing_) steps.push_back(step);
    return median(steps);
  }

  enum class Gap : std::uint8_t { good, wide, torn };

  /// The two inequalities of tejada2008, 5.3.
  Gap judge(const Member& a, const Member& b) const {
    const double gap = norm(place(b) - place(a));
    if (!(gap > options_.alpha * spacing_)) return Gap::good;
    if (full()) return Gap::torn;
    if (at_rim(a, b)) {
      const bool exact = options_.insertion == FlowInsertion::traced;
      return exact && span(a, b) > kRim * spacing_ ? Gap::wide : Gap::torn;
    }
    const double growth = gap - norm(b.was - a.was);
    const double own = std::min(norm(place(a) - a.was), norm(place(b) - b.was));
    if (!(growth < options_.beta * own)) return Gap::torn;
    return span(a, b) > least_span_ ? Gap::wide : Gap::torn;
  }

  /// Length of the seed curve from a to the next member b.
  double span(const Member& a, const Member& b) const { return span(a.s, b.s); }
  double span(double a, double b) const { return b > a ? b - a : b + length_ - a; }
  /// Midpoint on the seed curve.
  double middle(double a, double b) const {
    const double s = a + 0.5 * span(a, b);
    return s >= length_ && curve_.closed ? s - length_ : s;
  }

  /// Inserts particles until no fillable gap is too wide.
  void fill_gaps(double from, double to) {
    for (std::vector<std::uint32_t> wide;; wide.clear()) {
      for (std::size_t i = 0; i < next_.size(); ++i) {
        if (!next_[i].joined) continue;
        const Gap gap = judge(next_[i], next_[i + 1 < next_.size() ? i + 1 : 0]);
        if (gap == Gap::torn) next_[i].joined = false;
        if (gap == Gap::wide) wide.push_back(static_cast<std::uint32_t>(i));
      }
      if (wide.empty()) return;
      insert(wide, from, to, false);
    }
  }

  /// Separates neighbours across regions without flow.
  void pass_obstacles(double from, double to) {
    for (;;) {
      std::vector<std::uint32_t> narrower;
      for (const std::uint32_t i : blocked(to)) {
        const Member &a = next_[i], &b = next_[i + 1 < next_.size() ? i + 1 : 0];
        const bool can = options_.insertion == FlowInsertion::traced && !at_rim(a, b) && !full() &&
                         norm(place(b) - place(a)) > kObstacle * spacing_ && span(a, b) > least_span_;
        if (can)
          narrower.push_back(i);
        else
          next_[i].joined = false;
      }
      if (narrower.empty()) return;
      insert(narrower, from, to, true);
      fill_gaps(from, to);
    }
  }

  /// Inserts a particle after each member of `wide`; the surface tears where none exists.
  void insert(std::span<const std::uint32_t> wide, double from, double to, bool needed) {
    const std::size_t n = wide.size();
    std::vector<Member> fresh(n);
    std::vector<Vec3> halfway(n);
    std::vector<double> s(n);
    for (std::size_t k = 0; k < n; ++k) {
      const Member &a = next_[wide[k]], &b = after(wide[k]);
      s[k] = middle(a.s, b.s);
      fresh[k].s = s[k], fresh[k].joined = true, fresh[k].needed = needed;
      fresh[k].was = (a.was + b.was) * 0.5, halfway[k] = (place(a) + place(b)) * 0.5;
    }
    Particles p;
    if (options_.insertion == FlowInsertion::traced) {
      work_ += static_cast<double>(std::max(n, kLeastPass) * front_);
      std::vector<Vec3> was;
      find(s, wide, from, to, p, was);
      for (std::size_t k = 0; k < n; ++k) fresh[k].was = was[k];
    } else {
      p = particles_at(field_, halfway, std::vector<double>(n, to));
    }
    std::vector<Member> filled;
    filled.reserve(next_.size() + n);
    for (std::size_t i = 0, k = 0; i < next_.size(); ++i) {
      filled.push_back(next_[i]);
      if (k == n || wide[k] != i) continue;
      // The new particle ended: an obstacle, unless neighbours end too.
      const bool rim = at_rim(next_[i], next_[i + 1 < next_.size() ? i + 1 : 0]);
      if (p.ends[k] && (!rim || *p.ends[k] == TraceEnd::outside)) {
        filled.back().joined = false;
      } else {
        fresh[k].particle = append(p, k);
        filled.push_back(fresh[k]);
        ++inserted_;
      }
      ++k;
    }
    next_ = std::move(filled);
  }

  const Member& after(std::size_t i) const { return next_[i + 1 < next_.size() ? i + 1 : 0]; }

  /// Finds particles that start at arc lengths s, the midpoints of the gaps `wide`, and their positions at the previous
  /// front.
  void find(const std::vector<double>& s, std::span<const std::uint32_t> wide, double from, double to, Particles& p,
            std::vector<Vec3>& was) {
    if (field_.moments().empty()) return trace(s, from, to, p, was);
    const auto is_there = [this](double place) { return ahead_.has(place); };
    if (!std::all_of(s.begin(), s.end(), is_there)) {
      // Keeps the particles at midpoints; traces also those of the wider gaps, and of the halves of gaps that are
      // filled now.
      std::vector<double> kept(s), wanted(s);
      for (std::size_t i = 0, k = 0; i < next_.size(); ++i) {
        const Member &a = next_[i], &b = after(i);
        if (k < wide.size() && wide[k] == i) {
          wanted.insert(wanted.end(), {middle(a.s, s[k]), middle(s[k], b.s)});
          ++k;
        } else if (a.joined) {
          kept.push_back(middle(a.s, b.s));
          const bool near = !(norm(place(b) - place(a)) > kAhead * options_.alpha * spacing_);
          if (!near && !at_rim(a, b) && span(a, b) > least_span_) wanted.push_back(kept.back());
        }
      }
      std::sort(kept.begin(), kept.end());
      ahead_.keep(kept);
      std::sort(wanted.begin(), wanted.end());
      wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
      std::erase_if(wanted, is_there);
      Particles traced;
      std::vector<Vec3> were;
      trace(wanted, from, to, traced, were);
      ahead_.add(wanted, traced, were);
    }
    for (const double place : s) ahead_.take(place, p, was);
  }

  /// Traces from the seed curve to the previous front, and to this one.
  void trace(const std::vector<double>& s, double from, double to, Particles& p, std::vector<Vec3>& was) {
    std::vector<std::uint32_t> all(s.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<std::uint32_t>(k);
    p = particles_at(field_, curve_.at(s), std::vector<double>(s.size(), start_));
    // Uses the steps of its neighbours where the step length matters.
    if (FlowIntegrator::registry().at(trace_.integrator).order == 1)
      for (const double moment : moments_) move_particles(field_, p, all, moment, trace_);
    move_particles(field_, p, all, from, trace_);
    was = p.positions;
    move_particles(field_, p, all, to, trace_);
  }

  std::uint32_t append(const Particles& from, std::size_t k) {
    append_particle(particles_, from, k);
    names_.push_back(static_cast<std::uint32_t>(sheet_.report.particles++));
    return static_cast<std::uint32_t>(particles_.positions.size() - 1);
  }

  /// Members between which and the next one there is no flow half-way.
  std::vector<std::uint32_t> blocked(double time) const {
    std::vector<std::uint32_t> pairs;
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < next_.size(); ++i) {
      if (!next_[i].joined) continue;
      pairs.push_back(static_cast<std::uint32_t>(i));
      places.push_back((place(next_[i]) + place(next_[i + 1 < next_.size() ? i + 1 : 0])) * 0.5);
    }
    std::vector<Vec3> vectors(places.size());
    std::vector<std::uint8_t> inside(places.size());
    field_.evaluate(places, std::vector<double>(places.size(), time), vectors, inside);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k)
      if (inside[k] == 0) pairs[kept++] = pairs[k];
    pairs.resize(kept);
    return pairs;
  }

  /// A ribbon that tears somewhere ends as a whole, at the previous front: parts of it would be attached at single
  /// points.
  void drop_parted_insertions() {
    std::vector<Member> kept;
    kept.reserve(next_.size());
    for (std::size_t i = 0; i < next_.size();) {
      std::size_t last = i;
      bool whole = next_[i].joined;
      while (last + 1 < next_.size() && next_[last + 1].before == kNone) whole = next_[++last].joined && whole;
      kept.push_back(next_[i]);
      const bool had = members_[next_[i].before].joined;
      if (whole) {
        kept.insert(kept.end(), next_.begin() + static_cast<std::ptrdiff_t>(i + 1),
                    next_.begin() + static_cast<std::ptrdiff_t>(last + 1));
      } else {
        kept.back().joined = false;
        inserted_ -= last - i;
        const Member& other = next_[last + 1 < next_.size() ? last + 1 : 0];
        if (had && !ended(next_[i]) && !ended(other)) ++sheet_.report.tears;
      }
      i = last + 1;
    }
    next_ = std::move(kept);
  }

  /// Marks particles that are collinear with both neighbours and near them. Never two in a row.
  void remove_needless() {
    const std::size_t n = next_.size();
    std::size_t left = n;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t l = i > 0 ? i - 1 : n - 1, r = i + 1 < n ? i + 1 : 0;
      const Member &a = next_[l], &c = next_[r];
      Member& b = next_[i];
      if (left <= 4 || b.before == kNone || b.needed || !a.joined || !b.joined || a.removed || c.removed || ended(a) ||
          ended(b) || ended(c))
        continue;
      const Vec3 from = place(b) - place(a), on = place(c) - place(b);
      const double most = std::max(norm(from), norm(on));
      if (!(most < options_.delta * spacing_)) continue;
      if (most > kAtRest * spacing_ && !(dot(from, on) > kStraight * norm(from) * norm(on))) continue;
      b.removed = true;
      --left;
      ++sheet_.report.removed;
    }
  }

  /// The remaining member before or after i, if i is joined with it; else n.
  std::size_t neighbour(std::size_t i, bool after) const {
    const std::size_t n = next_.size();
    const auto step = [&](std::size_t k) { return after ? (k + 1 < n ? k + 1 : 0) : (k > 0 ? k - 1 : n - 1); };
    std::size_t k = step(i);
    if (!(after ? next_[i] : next_[k]).joined) return n;
    if (next_[k].removed) k = step(k);  // it is joined with both
    return k;
  }

  /// Adds points for members with a neighbour. Returns whether any has moved. Where fronts are close together because
  /// of few fast particles, slow ones keep their points for some fronts, except at the last one.
  bool make_points(bool last) {
    bool moved = false;
    const double rest = kAtRest * spacing_, slow = share_ < 1 && !last ? kSlow * spacing_ : rest;
    const std::size_t n = next_.size();
    for (std::size_t i = 0; i < n; ++i) {
      Member& m = next_[i];
      const std::size_t l = neighbour(i, false), r = neighbour(i, true);
      if (m.removed || (l == n && r == n)) continue;
      const Vec3& x = place(m);
      if (m.point != kNone) {
        const double since = norm(x - sheet_.points[m.point].position);
        if (since < rest) continue;
        moved = true;
        if (since < slow && !ended(m)) continue;
      }
      moved = true;
      // Direction along the front: slope of the parabola through both neighbours.
      Vec3 along;
      if (l < n && r < n) {
        const Vec3 a = x - place(next_[l]), b = place(next_[r]) - x;
        const double la = norm(a), lb = norm(b);
        along = a * (lb / std::max(la, 1e-300)) + b * (la / std::max(lb, 1e-300));
      } else {
        along = l < n ? x - place(next_[l]) : place(next_[r]) - x;
      }
      FlowPoint point;
      point.position = x, point.velocity = particles_.velocities[m.particle];
      // Where both are nearly parallel, the triangles determine the normal.
      const Vec3 normal = cross(along, point.velocity);
      if (norm(normal) > 1e-3 * norm(along) * norm(point.velocity)) point.normal = normalized(normal);
      point.s = m.s, point.t = particles_.times[m.particle];
      point.front = static_cast<std::int32_t>(front_) * (trace_.backward ? -1 : 1);
      point.particle = names_[m.particle];
      m.point = static_cast<std::uint32_t>(sheet_.points.size());
      sheet_.points.push_back(point);
    }
    return moved;
  }

  /// Triangles between the previous front and this one.
  void make_triangles() {
    const std::size_t n = members_.size();
    // Current index of the members of the previous front.
    std::vector<std::uint32_t> now(n);
    for (std::size_t i = 0; i < next_.size(); ++i)
      if (next_[i].before != kNone) now[next_[i].before] = static_cast<std::uint32_t>(i);
    std::vector<std::uint32_t> lower, upper;
    for (std::size_t k = 0; k < n; ++k) {
      if (next_[now[k]].removed || !next_[now[k]].joined) continue;
      std::size_t other = k + 1 < n ? k + 1 : 0;
      lower = {members_[k].point};
      if (next_[now[other]].removed) {
        lower.push_back(members_[other].point);
        other = other + 1 < n ? other + 1 : 0;
      }
      lower.push_back(members_[other].point);
      upper = {next_[now[k]].point};
      for (std::size_t i = now[k]; i != now[other];) {
        i = i + 1 < next_.size() ? i + 1 : 0;
        if (!next_[i].removed) upper.push_back(next_[i].point);
      }
      zip(lower, upper);
    }
  }

  /// Triangulates between two rows of points, each time with the shorter diagonal.
  void zip(const std::vector<std::uint32_t>& lower, const std::vector<std::uint32_t>& upper) {
    const auto distance = [&](std::uint32_t a, std::uint32_t b) {
      return squared_norm(sheet_.points[a].position - sheet_.points[b].position);
    };
    std::size_t i = 0, j = 0;
    while (i + 1 < lower.size() || j + 1 < upper.size()) {
      const bool below = j + 1 == upper.size() ||
                         (i + 1 < lower.size() && distance(lower[i + 1], upper[j]) <= distance(lower[i], upper[j + 1]));
      Triangle t = below ? Triangle{lower[i], lower[i + 1], upper[j]} : Triangle{lower[i], upper[j + 1], upper[j]};
      ++(below ? i : j);
      // Particles at rest have one point for both rows.
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      if (trace_.backward) std::swap(t[1], t[2]);
      sheet_.triangles.push_back(t);
    }
  }

  /// Keeps members with a neighbour, if one of the two continues: beside a particle that has ended, its neighbours
  /// still sweep the region between.
  void keep_those_that_go_on() {
    members_.clear();
    const std::size_t n = next_.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (next_[i].removed) continue;
      const auto sweeps = [&](std::size_t other) { return other < n && !(ended(next_[i]) && ended(next_[other])); };
      const bool after = sweeps(neighbour(i, true));
      if (!after && !sweeps(neighbour(i, false))) continue;
      members_.push_back(next_[i]);
      members_.back().joined = after;
    }
  }

  const VectorField& field_;
  const SeedCurve& curve_;
  const FlowSurfaceOptions& options_;
  TraceOptions trace_;
  double start_ = 0, length_ = 0, spacing_ = 0, least_span_ = 0;
  FlowSheet sheet_;
  Particles particles_, seeds_;       // particles of this direction; particles at their starts
  std::vector<std::uint32_t> names_;  // indices of particles_, the same in both directions
  std::vector<Member> members_, next_, first_;
  std::vector<double> moments_;    // moments of the fronts up to the previous one
  ParticlesAhead ahead_;           // particles traced along in this direction
  double share_ = 1;               // time between fronts over that at median speed
  double way_ = 0, most_way_ = 0;  // sums of the particles' median steps
  std::size_t front_ = 0, inserted_ = 0;
  double work_ = 0;  // moves of a particle to a front
};

}  // namespace

double least_seed_distance(const VectorField& field, const TraceOptions& options) {
  return kTooNear * trace_tolerance(field, options);
}

double front_time(std::vector<double> speeds, double spacing) {
  const auto middle = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2);
  std::nth_element(speeds.begin(), middle, speeds.end());
  if (!(*middle > 0)) throw DataError("the flow is at rest on at least half of the seed curve");
  return spacing / *middle;
}

FlowSheet advance_fronts(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options,
                         Progress& progress) {
  Fronts fronts(field, curve, options);
  if (options.direction != FlowDirection::backward) fronts.run(false, progress);
  if (options.direction != FlowDirection::forward) fronts.run(true, progress);
  return fronts.take();
}

}  // namespace sansmesh::inline v1
