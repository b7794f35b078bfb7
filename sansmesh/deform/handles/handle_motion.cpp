#include "sansmesh/deform/handles/handle_motion.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "sansmesh/deform/mls/rotation_fit.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kNoTurn = 1e-9;  // radians: below it a motion is a translation

Vec3 turned(const Vec3& v, const Vec3& axis, double angle) {
  const double c = std::cos(angle);
  return v * c + cross(axis, v) * std::sin(angle) + axis * (dot(axis, v) * (1 - c));
}

/// A rotation by `angle` about the line through `point` along `axis`, and a translation along it.
struct Screw {
  Vec3 axis{0, 0, 1}, point, way;
  double angle = 0;

  Vec3 operator()(const Vec3& x, double share) const {
    return (angle == 0 ? x : point + turned(x - point, axis, share * angle)) + way * share;
  }
  Vec3 direction(const Vec3& v, double share) const { return angle == 0 ? v : turned(v, axis, share * angle); }
};

struct AxisAngle {
  Vec3 axis{0, 0, 1};
  double angle = 0;
};

/// Axis and angle of the rotation with these rows.
AxisAngle axis_angle(const detail::Rows3& r) {
  const Vec3 k{r[2].y - r[1].z, r[0].z - r[2].x, r[1].x - r[0].y};  // 2 sin(angle) axis
  const double s = 0.5 * norm(k), c = 0.5 * (r[0].x + r[1].y + r[2].z - 1), angle = std::atan2(s, c);
  if (angle < kNoTurn) return {};
  if (c > 0) return {normalized(k), angle};
  // Near half a turn the sine is inaccurate: the symmetric part is c I + (1 - c) e eᵀ; use the longest row of e eᵀ.
  Vec3 axis;
  for (std::size_t i = 0; i < 3; ++i) {
    Vec3 row = (r[i] + Vec3{r[0][i], r[1][i], r[2][i]}) * 0.5;
    row[i] -= c;
    if (norm(row) > norm(axis)) axis = row;
  }
  axis = normalized(axis);
  return {dot(axis, k) < 0 ? -axis : axis, angle};
}

/// Smallest rotation from one unit vector to another.
AxisAngle smallest_turn(const Vec3& from, const Vec3& to) {
  const Vec3 axis = cross(from, to);
  const double angle = std::atan2(norm(axis), dot(from, to));
  if (angle < kNoTurn) return {};
  if (norm(axis) > 0) return {normalized(axis), angle};
  Vec3 side, other;
  tangent_frame(from, side, other);
  return {side, angle};
}

/// The screw motion with a given rotation that takes one point to another.
Screw screw_of(const AxisAngle& turn, const Vec3& from, const Vec3& to) {
  Screw screw;
  screw.way = to - from;
  if (turn.angle == 0) return screw;
  screw.axis = turn.axis, screw.angle = turn.angle;
  const Vec3 along = turn.axis * dot(turn.axis, screw.way), across = screw.way - along;
  // From the axis, the chord `across` subtends the rotation angle.
  screw.point = from + across * 0.5 + cross(turn.axis, across) * (0.5 / std::tan(0.5 * turn.angle));
  screw.way = along;
  return screw;
}

/// Points of handles: positions and segment ends.
struct MovedPoint {
  Vec3 p, q;
  double weight;
};

Screw screw_of(std::span<const Handle> handles, std::span<const std::size_t> of) {
  std::vector<MovedPoint> points;
  for (const std::size_t i : of) {
    const Handle& h = handles[i];
    points.push_back({h.p, h.q, h.weight});
    if (h.p_end) points.push_back({*h.p_end, *h.q_end, h.weight});
  }
  Vec3 p, q;
  double sum = 0;
  for (const MovedPoint& m : points) p += m.p * m.weight, q += m.q * m.weight, sum += m.weight;
  p = p / sum, q = q / sum;
  // Σ w q pᵀ about the means; directions count as points at the mean distance of the others.
  detail::Rows3 b{};
  const auto add = [&b](const Vec3& from, const Vec3& to, double weight) {
    for (std::size_t k = 0; k < 3; ++k) b[k] += from * (to[k] * weight);
  };
  double spread = 0;
  for (const MovedPoint& m : points) add(m.p - p, m.q - q, m.weight), spread += m.weight * squared_norm(m.p - p);
  spread = spread > 0 ? spread / sum : 1;
  for (const std::size_t i : of)
    for (const TurnedDirection& d : handles[i].directions) add(d.before, d.after, handles[i].weight * spread);
  double size = 0;
  for (const Vec3& row : b) size = std::max(size, norm(row));
  return screw_of(size > 0 ? axis_angle(detail::best_rotation(b)) : AxisAngle{}, p, q);
}

}  // namespace

std::vector<Handle> handles_at(std::span<const Handle> handles, double share) {
  if (share == 1) return {handles.begin(), handles.end()};
  std::map<std::string, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < handles.size(); ++i)
    if (!handles[i].group.empty()) groups[handles[i].group].push_back(i);
  std::vector<Screw> screws(handles.size());
  for (std::size_t i = 0; i < handles.size(); ++i) {
    if (!handles[i].group.empty()) continue;
    screws[i].way = handles[i].q - handles[i].p;
  }
  for (const auto& [name, of] : groups) {
    const Screw screw = screw_of(handles, of);
    for (const std::size_t i : of) screws[i] = screw;
  }
  std::vector<Handle> now(handles.begin(), handles.end());
  for (std::size_t i = 0; i < now.size(); ++i) {
    Handle& h = now[i];
    const Screw& screw = screws[i];
    const auto target = [&](const Vec3& p, const Vec3& q) { return screw(p, share) + (q - screw(p, 1)) * share; };
    h.q = target(h.p, h.q);
    if (h.p_end) h.q_end = target(*h.p_end, *h.q_end);
    // Remaining rotation of the directions after that of the group.
    if (h.directions.empty()) continue;
    detail::Rows3 rest{};
    for (const TurnedDirection& d : h.directions) {
      const Vec3 from = screw.direction(d.before, 1);
      for (std::size_t k = 0; k < 3; ++k) rest[k] += from * d.after[k];
    }
    const TurnedDirection& one = h.directions[0];
    const AxisAngle left = h.directions.size() == 1 ? smallest_turn(screw.direction(one.before, 1), one.after)
                                                    : axis_angle(detail::best_rotation(rest));
    for (TurnedDirection& d : h.directions)
      d.after = turned(screw.direction(d.before, share), left.axis, share * left.angle);
  }
  return now;
}

}  // namespace sansmesh::inline v1
