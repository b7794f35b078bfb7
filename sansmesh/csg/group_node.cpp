#include "sansmesh/csg/group_node.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "sansmesh/core/box.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/csg/solid_expression.h"

namespace sansmesh {
namespace {

constexpr std::size_t kClusterSize = 16;
/// Up to so many members are not sorted.
constexpr std::size_t kFewMembers = 24;
/// Of more members, a bound from below is not asked of each.
constexpr std::size_t kAskedForLeast = 8;
/// A survey with reach r tells how far a piece is alone up to this many r; as far as those of pairs do.
constexpr double kGroupSurveyed = 6;
/// How fast the difference of two values can change whose slopes are 1 at most.
constexpr double kDifferenceSlope = 2;
constexpr double kWidened = 1 + 1e-12;
/// So many points ask the same members.
constexpr std::size_t kFewPoints = 32;

struct AroundPoints {
  Vec3 center;
  double radius;

  explicit AroundPoints(std::span<const Vec3> x) {
    Box3 box;
    for (const Vec3& p : x) box.extend(p);
    center = box.center();
    radius = norm(box.size()) / 2 * kWidened;
    if (!std::isfinite(radius)) radius = kUnbounded;
  }
};

/// How far x lies outside of a box, in one direction.
double outside_of(const Extents& e, const Vec3& x) {
  double outside = -kUnbounded;
  for (std::size_t k = 0; k < 3; ++k) outside = std::max({outside, -x[k] - e[2 * k], x[k] - e[2 * k + 1]});
  return outside;
}

/// What values are at least within `radius` of a place so far outside.
double least_value(double outside, double rise, double radius) {
  return outside > radius ? rise * (outside - radius) : -kUnbounded;
}

std::uint32_t morton_cell_of(double x, double lower, double size) {
  return size > 0 ? static_cast<std::uint32_t>(std::clamp((x - lower) / size, 0.0, 1.0) * 1023) : 0;
}

}  // namespace

GroupNode::GroupNode(std::vector<NodePtr> members, double sign)
    : SolidNode(traits_of(members)), members_(std::move(members)), sign_(sign) {
  std::uint32_t pieces = 0;
  for (const NodePtr& m : members_) {
    first_piece_.push_back(pieces);
    pieces += m->pieces();
  }
  keep_extents();
  build_clusters();
}

SolidNode::Traits GroupNode::traits_of(std::span<const NodePtr> members) {
  Traits t;
  t.pieces = 0;
  t.cost = 0;
  for (const NodePtr& m : members) {
    t.pieces += m->pieces();
    t.rise = std::min(t.rise, m->rise());
    t.cost += m->cost();
    t.depth = std::max(t.depth, 1 + m->depth());
    t.thickness = thinner(t.thickness, m->thickness());
    t.hollow_thickness = thinner(t.hollow_thickness, m->hollow_thickness());
  }
  return t;
}

const Extents& GroupNode::extents_of(std::uint32_t member) const {
  return sign_ > 0 ? members_[member]->extents() : members_[member]->hollow_extents();
}

void GroupNode::build_clusters() {
  order_.resize(members_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  if (order_.size() > kFewMembers) {
    // Those without an end in some direction first, the others along a Morton curve.
    std::vector<Vec3> center(order_.size());
    Box3 all;
    for (const std::uint32_t m : order_) {
      const Extents& e = extents_of(m);
      for (std::size_t k = 0; k < 3; ++k) center[m][k] = (e[2 * k + 1] - e[2 * k]) / 2;
      if (is_finite(center[m])) all.extend(center[m]);
    }
    const Vec3 size = all.size();
    std::vector<std::uint64_t> key(order_.size());
    for (const std::uint32_t m : order_)
      if (is_finite(center[m]))
        key[m] = 1 + morton_code(morton_cell_of(center[m].x, all.lower.x, size.x),
                                 morton_cell_of(center[m].y, all.lower.y, size.y),
                                 morton_cell_of(center[m].z, all.lower.z, size.z));
    std::sort(order_.begin(), order_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return std::pair(key[a], a) < std::pair(key[b], b); });
  }
  for (std::size_t first = 0; first < order_.size(); first += kClusterSize) {
    Cluster c{extents_of(order_[first]), 1, static_cast<std::uint32_t>(first),
              static_cast<std::uint32_t>(std::min(first + kClusterSize, order_.size()))};
    for (std::uint32_t i = c.first; i < c.last; ++i) {
      const Extents& e = extents_of(order_[i]);
      for (std::size_t k = 0; k < 6; ++k) c.extents[k] = std::max(c.extents[k], e[k]);
      c.rise = std::min(c.rise, members_[order_[i]]->rise());
    }
    clusters_.push_back(c);
  }
}

std::vector<std::uint32_t> GroupNode::candidates(std::span<const Vec3> x, double room) const {
  const auto [center, radius] = AroundPoints(x);
  // The smallest value in the middle of the ball.
  double smallest = kUnbounded;
  for (const Cluster& c : clusters_) {
    if (least_value(outside_of(c.extents, center), c.rise, 0) >= smallest) continue;
    for (std::uint32_t i = c.first; i < c.last; ++i) {
      const SolidNode& m = *members_[order_[i]];
      if (least_value(outside_of(extents_of(order_[i]), center), m.rise(), 0) >= smallest) continue;
      double value = 0;
      m.evaluate({&center, 1}, {&value, 1}, {}, {});
      smallest = std::min(smallest, sign_ * value);
    }
  }
  const double most = smallest + radius + room;
  std::vector<std::uint32_t> found;
  for (const Cluster& c : clusters_) {
    if (least_value(outside_of(c.extents, center), c.rise, radius) > most) continue;
    for (std::uint32_t i = c.first; i < c.last; ++i)
      if (!(least_value(outside_of(extents_of(order_[i]), center), members_[order_[i]]->rise(), radius) > most))
        found.push_back(order_[i]);
  }
  std::sort(found.begin(), found.end());
  return found;
}

void GroupNode::narrow(std::span<const std::uint32_t> candidates, std::span<const Vec3> x, double room,
                       std::vector<std::uint32_t>& found) const {
  const auto [center, radius] = AroundPoints(x);
  found.clear();
  double smallest = kUnbounded;
  std::vector<double> value(candidates.size());
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    members_[candidates[c]]->evaluate({&center, 1}, {&value[c], 1}, {}, {});
    value[c] *= sign_;
    smallest = std::min(smallest, value[c]);
  }
  // Twice the radius: the smallest one may rise, and the other fall. (Rounding is far below what `kWidened` leaves.)
  for (std::size_t c = 0; c < candidates.size(); ++c)
    if (!(value[c] > smallest + 2 * radius + room + 1e-12 * std::abs(smallest))) found.push_back(candidates[c]);
}

void GroupNode::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                         std::span<std::uint32_t> active) const {
  if (x.empty()) return;
  const std::vector<std::uint32_t> near = candidates(x, 0);
  std::vector<std::uint32_t> asked;
  std::array<double, kFewPoints> value_of;
  std::array<Vec3, kFewPoints> slope_of;
  std::array<std::uint32_t, kFewPoints> piece_of;
  for (std::size_t begin = 0; begin < x.size(); begin += kFewPoints) {
    const std::size_t n = std::min(kFewPoints, x.size() - begin);
    const auto at = x.subspan(begin, n);
    const auto value = values.subspan(begin, n), other = std::span(value_of).first(n);
    const auto slope = gradients.empty() ? gradients : gradients.subspan(begin, n);
    const auto piece = active.empty() ? active : active.subspan(begin, n);
    const auto other_slope = std::span(slope_of).first(slope.size());
    const auto other_piece = std::span(piece_of).first(piece.size());
    if (near.size() > 2 && n > 2) {
      narrow(near, at, 0, asked);
    } else {
      asked = near;
    }
    for (const std::uint32_t m : asked) {
      if (m == asked.front()) {
        members_[m]->evaluate(at, value, slope, piece);
        for (std::uint32_t& p : piece) p += first_piece_[m];
        continue;
      }
      members_[m]->evaluate(at, other, other_slope, other_piece);
      for (std::size_t i = 0; i < n; ++i) {
        if (!(sign_ * other[i] < sign_ * value[i])) continue;
        value[i] = other[i];
        if (!slope.empty()) slope[i] = other_slope[i];
        if (!piece.empty()) piece[i] = first_piece_[m] + other_piece[i];
      }
    }
  }
}

void GroupNode::evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                               std::span<Vec3> gradients) const {
  const auto m = static_cast<std::size_t>(std::upper_bound(first_piece_.begin(), first_piece_.end(), piece) -
                                          first_piece_.begin() - 1);
  members_[m]->evaluate_piece(piece - first_piece_[m], x, values, gradients);
}

void GroupNode::survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
                       std::span<Surroundings> around, std::span<ValueRange>) const {
  if (x.empty()) return;
  const double room = kGroupSurveyed * reach.detail * kDifferenceSlope;
  const std::vector<std::uint32_t> near = candidates(x, room);
  std::vector<std::uint32_t> asked;
  std::array<double, kFewPoints> value_of, second;  // the second smallest one, with the sign of the group
  std::array<Surroundings, kFewPoints> around_of;
  std::array<ValueRange, kFewPoints> unused;
  for (std::size_t begin = 0; begin < x.size(); begin += kFewPoints) {
    const std::size_t n = std::min(kFewPoints, x.size() - begin);
    const auto at = x.subspan(begin, n);
    const auto value = values.subspan(begin, n), other = std::span(value_of).first(n);
    const auto surroundings = around.subspan(begin, n), other_around = std::span(around_of).first(n);
    narrow(near, at, room, asked);
    second.fill(kUnbounded);
    for (const std::uint32_t m : asked) {
      const bool first = m == asked.front();
      members_[m]->survey(at, reach, first ? value : other, first ? surroundings : other_around,
                          std::span(unused).first(n));
      if (first) continue;
      for (std::size_t i = 0; i < n; ++i) {
        const double new_one = sign_ * other[i], old_one = sign_ * value[i];
        second[i] = std::min(second[i], std::max(new_one, old_one));
        if (new_one < old_one) value[i] = other[i], surroundings[i] = other_around[i];
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      double gap = second[i] - sign_ * value[i];
      if (asked.size() < members_.size()) gap = std::min(gap, room);
      surroundings[i].alone = std::min(surroundings[i].alone, gap / kDifferenceSlope);
    }
  }
}

double GroupNode::least(double sign, const Vec3& x, double radius) const {
  double bound = far_value(sign, x, radius);
  if (members_.size() > kAskedForLeast) return bound;
  double all = sign == sign_ ? kUnbounded : -kUnbounded;
  for (const NodePtr& m : members_) {
    const double one = m->least(sign, x, radius);
    all = sign == sign_ ? std::min(all, one) : std::max(all, one);
  }
  return std::max(bound, all);
}

std::optional<std::uint32_t> GroupNode::express(ExpressionBuilder& builder, const ExpressionFrame& frame) const {
  return builder.combine(members_, sign_, frame);
}

double GroupNode::support_of(const Vec3& n, double sign, bool largest) const {
  // In the directions of the axes members know it.
  std::size_t axis = 6;
  for (std::size_t k = 0; k < 3; ++k)
    if (std::abs(n[k]) == 1 && n[(k + 1) % 3] == 0 && n[(k + 2) % 3] == 0) axis = 2 * k + (n[k] > 0 ? 1 : 0);
  double found = largest ? -kUnbounded : kUnbounded;
  for (const NodePtr& m : members_) {
    const double one = axis < 6   ? (sign > 0 ? m->extents() : m->hollow_extents())[axis]
                       : sign > 0 ? m->support(n)
                                  : m->hollow_support(n);
    found = largest ? std::max(found, one) : std::min(found, one);
  }
  return found;
}

double GroupNode::support(const Vec3& n) const { return support_of(n, 1, sign_ > 0); }
double GroupNode::hollow_support(const Vec3& n) const { return support_of(n, -1, sign_ < 0); }

NodePtr group_of(const NodePtr& a, const NodePtr& b, double sign) {
  std::vector<NodePtr> members;
  for (const NodePtr& node : {a, b}) {
    const auto* group = dynamic_cast<const GroupNode*>(node.get());
    if (group && group->sign() == sign) {
      members.insert(members.end(), group->members().begin(), group->members().end());
    } else {
      members.push_back(node);
    }
  }
  return std::make_shared<GroupNode>(std::move(members), sign);
}

}  // namespace sansmesh
