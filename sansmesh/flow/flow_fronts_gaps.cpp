// FlowFronts: insertion of particles and tears.
#include <algorithm>

#include "sansmesh/flow/flow_fronts.h"
#include "sansmesh/flow/flow_integrator.h"

namespace sansmesh::inline v1 {
namespace {

/// Where one neighbour has ended, the other continues beside a rim, which is resolved to this fraction of Δ₀ on the
/// seed curve.
constexpr double kRim = 1.0 / 64;
/// Gaps across a region without flow are filled until they are this narrow, over Δ₀: the surface then passes beside a
/// round obstacle.
constexpr double kObstacle = 1.0 / 8;
/// Gaps wider than this fraction of the widest may need a particle soon, before those filled now are halved again.
constexpr double kAhead = 1.0 / 4;
/// Tracing fewer particles than this from their seeds takes no less time.
constexpr std::size_t kLeastPass = 16;

}  // namespace

FlowFronts::Gap FlowFronts::judge(const FrontMember& a, const FrontMember& b) const {
  const double gap = norm(position(b) - position(a));
  if (!(gap > options_.alpha * spacing_)) return Gap::good;
  if (full()) return Gap::torn;
  if (at_rim(a, b)) {
    const bool exact = options_.insertion == FlowInsertion::traced;
    return exact && span(a, b) > kRim * spacing_ ? Gap::wide : Gap::torn;
  }
  const double growth = gap - norm(b.was - a.was);
  const double own = std::min(norm(position(a) - a.was), norm(position(b) - b.was));
  if (!(growth < options_.beta * own)) return Gap::torn;
  return span(a, b) > least_span_ ? Gap::wide : Gap::torn;
}

void FlowFronts::fill_gaps(double from, double to) {
  for (std::vector<std::uint32_t> wide;; wide.clear()) {
    for (std::size_t i = 0; i < next_.size(); ++i) {
      if (!next_[i].joined) continue;
      const Gap gap = judge(next_[i], after(i));
      if (gap == Gap::torn) next_[i].joined = false;
      if (gap == Gap::wide) wide.push_back(static_cast<std::uint32_t>(i));
    }
    if (wide.empty()) return;
    insert(wide, from, to, false);
  }
}

void FlowFronts::pass_obstacles(double from, double to) {
  for (;;) {
    std::vector<std::uint32_t> narrower;
    for (const std::uint32_t i : blocked(to)) {
      const FrontMember &a = next_[i], &b = after(i);
      const bool can = options_.insertion == FlowInsertion::traced && !at_rim(a, b) && !full() &&
                       norm(position(b) - position(a)) > kObstacle * spacing_ && span(a, b) > least_span_;
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

void FlowFronts::insert(std::span<const std::uint32_t> wide, double from, double to, bool needed) {
  const std::size_t n = wide.size();
  std::vector<FrontMember> fresh(n);
  std::vector<Vec3> halfway(n);
  std::vector<double> s(n);
  for (std::size_t k = 0; k < n; ++k) {
    const FrontMember &a = next_[wide[k]], &b = after(wide[k]);
    s[k] = middle(a.s, b.s);
    fresh[k].s = s[k], fresh[k].joined = true, fresh[k].needed = needed;
    fresh[k].was = (a.was + b.was) * 0.5, halfway[k] = (position(a) + position(b)) * 0.5;
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
  std::vector<FrontMember> filled;
  filled.reserve(next_.size() + n);
  for (std::size_t i = 0, k = 0; i < next_.size(); ++i) {
    filled.push_back(next_[i]);
    if (k == n || wide[k] != i) continue;
    // The new particle ended: an obstacle, unless neighbours end too.
    const bool rim = at_rim(next_[i], after(i));
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

void FlowFronts::find(const std::vector<double>& s, std::span<const std::uint32_t> wide, double from, double to,
                      Particles& p, std::vector<Vec3>& was) {
  if (field_.sample_times().empty()) return trace(s, from, to, p, was);
  const auto is_there = [this](double seed) { return ahead_.has(seed); };
  if (!std::all_of(s.begin(), s.end(), is_there)) {
    // Keeps the particles at midpoints; traces also those of the wider gaps, and of the halves of gaps that are
    // filled now.
    std::vector<double> kept(s), wanted(s);
    for (std::size_t i = 0, k = 0; i < next_.size(); ++i) {
      const FrontMember &a = next_[i], &b = after(i);
      if (k < wide.size() && wide[k] == i) {
        wanted.insert(wanted.end(), {middle(a.s, s[k]), middle(s[k], b.s)});
        ++k;
      } else if (a.joined) {
        kept.push_back(middle(a.s, b.s));
        const bool near = !(norm(position(b) - position(a)) > kAhead * options_.alpha * spacing_);
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
  for (const double seed : s) ahead_.take(seed, p, was);
}

void FlowFronts::trace(const std::vector<double>& s, double from, double to, Particles& p, std::vector<Vec3>& was) {
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

std::uint32_t FlowFronts::append(const Particles& from, std::size_t k) {
  append_particle(particles_, from, k);
  names_.push_back(static_cast<std::uint32_t>(sheet_.report.particles++));
  return static_cast<std::uint32_t>(particles_.positions.size() - 1);
}

std::vector<std::uint32_t> FlowFronts::blocked(double time) const {
  std::vector<std::uint32_t> pairs;
  std::vector<Vec3> middles;
  for (std::size_t i = 0; i < next_.size(); ++i) {
    if (!next_[i].joined) continue;
    pairs.push_back(static_cast<std::uint32_t>(i));
    middles.push_back((position(next_[i]) + position(after(i))) * 0.5);
  }
  std::vector<Vec3> vectors(middles.size());
  std::vector<std::uint8_t> inside(middles.size());
  field_.evaluate(middles, std::vector<double>(middles.size(), time), vectors, inside);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (inside[k] == 0) pairs[kept++] = pairs[k];
  pairs.resize(kept);
  return pairs;
}

void FlowFronts::drop_parted_insertions() {
  std::vector<FrontMember> kept;
  kept.reserve(next_.size());
  for (std::size_t i = 0; i < next_.size();) {
    std::size_t last = i;
    bool whole = next_[i].joined;
    while (last + 1 < next_.size() && next_[last + 1].before == FrontMember::kNone)
      whole = next_[++last].joined && whole;
    kept.push_back(next_[i]);
    const bool had = members_[next_[i].before].joined;
    if (whole) {
      kept.insert(kept.end(), next_.begin() + static_cast<std::ptrdiff_t>(i + 1),
                  next_.begin() + static_cast<std::ptrdiff_t>(last + 1));
    } else {
      kept.back().joined = false;
      inserted_ -= last - i;
      const FrontMember& other = after(last);
      if (had && !ended(next_[i]) && !ended(other)) ++sheet_.report.tears;
    }
    i = last + 1;
  }
  next_ = std::move(kept);
}

}  // namespace sansmesh::inline v1
