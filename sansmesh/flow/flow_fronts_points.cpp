// FlowFronts: removal of particles, points and triangles.
#include <algorithm>

#include "sansmesh/flow/flow_fronts.h"

namespace sansmesh::inline v1 {
namespace {

/// Cosine of the angle between the directions to both neighbours above which a particle is collinear with them (10°).
constexpr double kStraight = 0.985;
/// Where fronts are closer together because of fast particles, particles that moved less than this, over Δ₀, since
/// their last point keep it.
constexpr double kSlow = 0.5;

}  // namespace

void FlowFronts::remove_needless() {
  const std::size_t n = next_.size();
  std::size_t left = n;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t l = i > 0 ? i - 1 : n - 1, r = i + 1 < n ? i + 1 : 0;
    const FrontMember &a = next_[l], &c = next_[r];
    FrontMember& b = next_[i];
    if (left <= 4 || b.before == FrontMember::kNone || b.needed || !a.joined || !b.joined || a.removed || c.removed ||
        ended(a) || ended(b) || ended(c))
      continue;
    const Vec3 from = position(b) - position(a), on = position(c) - position(b);
    const double most = std::max(norm(from), norm(on));
    if (!(most < options_.delta * spacing_)) continue;
    if (most > kAtRest * spacing_ && !(dot(from, on) > kStraight * norm(from) * norm(on))) continue;
    b.removed = true;
    --left;
    ++sheet_.report.removed;
  }
}

std::size_t FlowFronts::neighbour(std::size_t i, bool after) const {
  const std::size_t n = next_.size();
  const auto step = [&](std::size_t k) { return after ? (k + 1 < n ? k + 1 : 0) : (k > 0 ? k - 1 : n - 1); };
  std::size_t k = step(i);
  if (!(after ? next_[i] : next_[k]).joined) return n;
  if (next_[k].removed) k = step(k);  // it is joined with both
  return k;
}

bool FlowFronts::make_points(bool last) {
  bool moved = false;
  const double rest = kAtRest * spacing_, slow = share_ < 1 && !last ? kSlow * spacing_ : rest;
  const std::size_t n = next_.size();
  for (std::size_t i = 0; i < n; ++i) {
    FrontMember& m = next_[i];
    const std::size_t l = neighbour(i, false), r = neighbour(i, true);
    if (m.removed || (l == n && r == n)) continue;
    const Vec3& x = position(m);
    if (m.point != FrontMember::kNone) {
      const double since = norm(x - sheet_.points[m.point].position);
      if (since < rest) continue;
      moved = true;
      if (since < slow && !ended(m)) continue;
    }
    moved = true;
    // Direction along the front: slope of the parabola through both neighbours.
    Vec3 along;
    if (l < n && r < n) {
      const Vec3 a = x - position(next_[l]), b = position(next_[r]) - x;
      const double la = norm(a), lb = norm(b);
      along = a * (lb / std::max(la, 1e-300)) + b * (la / std::max(lb, 1e-300));
    } else {
      along = l < n ? x - position(next_[l]) : position(next_[r]) - x;
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

void FlowFronts::make_triangles() {
  const std::size_t n = members_.size();
  // Current index of the members of the previous front.
  std::vector<std::uint32_t> now(n);
  for (std::size_t i = 0; i < next_.size(); ++i)
    if (next_[i].before != FrontMember::kNone) now[next_[i].before] = static_cast<std::uint32_t>(i);
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
      i = next_index(i);
      if (!next_[i].removed) upper.push_back(next_[i].point);
    }
    zip(lower, upper);
  }
}

void FlowFronts::zip(const std::vector<std::uint32_t>& lower, const std::vector<std::uint32_t>& upper) {
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

void FlowFronts::keep_continuing() {
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

}  // namespace sansmesh::inline v1
