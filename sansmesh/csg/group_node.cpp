#include "sansmesh/csg/group_node.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/csg/face_builder.h"
#include "sansmesh/csg/solid_expression.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kClusterSize = 16;
/// Up to this many members are not sorted.
constexpr std::size_t kFewMembers = 24;
/// With more members, lower bounds are not queried from each.
constexpr std::size_t kAskedForLeast = 8;
/// Number of points that share a selection of members.
constexpr std::size_t kFewPoints = 32;
/// A member that costs more than this share of the group and is deeper than kShallow nodes is not evaluated at the
/// centres of balls.
constexpr double kHeavyShare = 0.5;
constexpr int kShallow = 4;

/// A ball around points.
struct AroundPoints {
  Vec3 center;
  double radius;
  double rounding;  ///< rounding error of the values of a node there

  AroundPoints(std::span<const Vec3> x, const SolidNode& node) {
    Box3 box;
    for (const Vec3& p : x) box.extend(p);
    center = x.size() == 1 ? x[0] : box.center();
    radius = norm(box.size()) / 2;
    rounding = value_rounding(node, center, radius);
    if (!std::isfinite(radius)) radius = kUnbounded;
  }
};

std::uint32_t morton_cell_of(double x, double lower, double size) {
  return size > 0 ? index_in<std::uint32_t>((x - lower) / size * 1023, 0, 1023) : 0;
}

}  // namespace

GroupNode::GroupNode(std::vector<NodePtr> members, double sign)
    : SolidNode(traits_of(members)), members_(std::move(members)), sign_(sign) {
  std::uint32_t pieces = 0;
  for (const NodePtr& m : members_) {
    first_piece_.push_back(pieces);
    pieces += m->pieces();
  }
  for (std::uint32_t m = 0; m < members_.size(); ++m)
    if (members_[m]->depth() > kShallow && members_[m]->cost() > kHeavyShare * cost()) heavy_ = m;
  keep_extents();
  build_clusters();
}

SolidNode::Traits GroupNode::traits_of(std::span<const NodePtr> members) {
  Traits t;
  t.pieces = 0;
  t.cost = 0;
  for (const NodePtr& m : members) t.join(*m);
  return t;
}

const Extents& GroupNode::extents_of(std::uint32_t member) const {
  return sign_ > 0 ? members_[member]->extents() : members_[member]->hollow_extents();
}

void GroupNode::build_clusters() {
  order_.resize(members_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  if (order_.size() > kFewMembers) {
    // Unbounded members first, the others along a Morton curve.
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

// Excluded members exceed the smallest value by more than the rounding errors of both. Therefore members that are
// exactly equal to the smallest value are always evaluated, and the first of them is active, independent of the number
// of points.

std::vector<GroupNode::Near> GroupNode::candidates(std::span<const Vec3> x, double room) const {
  const AroundPoints ball(x, *this);
  // Smallest value at the centre of the ball, of the members evaluated there.
  double smallest = kUnbounded;
  std::vector<Near> found;
  const auto far = [&](const Extents& e, double rise, double radius, double most) {
    return least_value(outside_of(e, ball.center), rise, radius) > most + ball.rounding;
  };
  for (const Cluster& c : clusters_) {
    if (far(c.extents, c.rise, ball.radius, smallest + ball.radius + room)) continue;
    for (std::uint32_t i = c.first; i < c.last; ++i) {
      const std::uint32_t member = order_[i];
      const SolidNode& m = *members_[member];
      const Extents& e = extents_of(member);
      if (far(e, m.rise(), ball.radius, smallest + ball.radius + room)) continue;
      found.push_back({member, false, 0});
      if (member == heavy_ || far(e, m.rise(), 0, smallest)) continue;
      ask(found.back(), ball.center);
      smallest = std::min(smallest, found.back().value);
    }
  }
  leave_out_far(found, ball.radius, room, ball.rounding, smallest, ball.center);
  std::sort(found.begin(), found.end(), [](const Near& a, const Near& b) { return a.member < b.member; });
  return found;
}

void GroupNode::ask(Near& near, const Vec3& x) const {
  members_[near.member]->evaluate({&x, 1}, {&near.value, 1}, {}, {});
  near.value *= sign_;
  near.asked = true;
}

void GroupNode::leave_out_far(std::vector<Near>& found, double radius, double room, double rounding, double smallest,
                              const Vec3& center) const {
  std::erase_if(found, [&](const Near& n) {
    // Twice the radius, because the smallest value may rise while the other falls.
    if (n.asked) return n.value > smallest + 2 * radius + room + rounding;
    const SolidNode& m = *members_[n.member];
    return least_value(outside_of(extents_of(n.member), center), m.rise(), radius) >
           smallest + radius + room + rounding;
  });
}

void GroupNode::narrow(std::vector<Near>& found, std::span<const Vec3> x, double room) const {
  const AroundPoints ball(x, *this);
  double smallest = kUnbounded;
  for (Near& n : found) {
    n.asked = false;
    if (n.member == heavy_) continue;
    ask(n, ball.center);
    smallest = std::min(smallest, n.value);
  }
  leave_out_far(found, ball.radius, room, ball.rounding, smallest, ball.center);
}

void GroupNode::evaluate_one(const Vec3& x, double& value, std::span<Vec3> gradient,
                             std::span<std::uint32_t> active) const {
  const double rounding = value_rounding(*this, x, 0);
  double smallest = kUnbounded, other = 0;
  std::uint32_t best = kNoMember, piece = 0;
  Vec3 slope;
  const auto far = [&](const Extents& e, double rise) {
    return least_value(outside_of(e, x), rise, 0) > smallest + rounding;
  };
  const auto consider = [&](std::uint32_t m) {
    if (far(extents_of(m), members_[m]->rise())) return;
    members_[m]->evaluate({&x, 1}, {&other, 1}, std::span(&slope, gradient.size()), std::span(&piece, active.size()));
    if (best != kNoMember && !(sign_ * other < smallest) && !(sign_ * other == smallest && m < best)) return;
    best = m, smallest = sign_ * other, value = other;
    if (!gradient.empty()) gradient[0] = slope;
    if (!active.empty()) active[0] = first_piece_[m] + piece;
  };
  for (const Cluster& c : clusters_) {
    if (far(c.extents, c.rise)) continue;
    for (std::uint32_t i = c.first; i < c.last; ++i)
      if (order_[i] != heavy_) consider(order_[i]);
  }
  if (heavy_ != kNoMember) consider(heavy_);
}

void GroupNode::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                         std::span<std::uint32_t> active) const {
  if (x.empty()) return;
  if (x.size() == 1) return evaluate_one(x[0], values[0], gradients, active);
  struct Others {
    std::array<double, kFewPoints> value;
    std::array<Vec3, kFewPoints> slope;
    std::array<std::uint32_t, kFewPoints> piece;
  };
  const auto others = std::make_unique_for_overwrite<Others>();  // on the heap, because trees may be deep
  const std::vector<Near> near = candidates(x, 0);
  std::vector<Near> asked;
  for (std::size_t begin = 0; begin < x.size(); begin += kFewPoints) {
    const std::size_t n = std::min(kFewPoints, x.size() - begin);
    const auto at = x.subspan(begin, n);
    const auto value = values.subspan(begin, n), other = std::span(others->value).first(n);
    const auto slope = gradients.empty() ? gradients : gradients.subspan(begin, n);
    const auto piece = active.empty() ? active : active.subspan(begin, n);
    const auto other_slope = std::span(others->slope).first(slope.size());
    const auto other_piece = std::span(others->piece).first(piece.size());
    asked = near;
    if (near.size() > 2 && n > 2 && n < x.size()) narrow(asked, at, 0);
    for (const Near& one : asked) {
      const std::uint32_t m = one.member;
      if (m == asked.front().member) {
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
  const double room = kSurveyed * reach.detail * kDifferenceSlope;
  struct Others {
    std::array<double, kFewPoints> value, second;  // the second smallest value, with the sign of the group
    std::array<Surroundings, kFewPoints> around;
    std::array<ValueRange, kFewPoints> unused;
  };
  const auto others = std::make_unique_for_overwrite<Others>();
  auto& second = others->second;
  const std::vector<Near> near = candidates(x, room);
  std::vector<Near> asked;
  for (std::size_t begin = 0; begin < x.size(); begin += kFewPoints) {
    const std::size_t n = std::min(kFewPoints, x.size() - begin);
    const auto at = x.subspan(begin, n);
    const auto value = values.subspan(begin, n), other = std::span(others->value).first(n);
    const auto surroundings = around.subspan(begin, n), other_around = std::span(others->around).first(n);
    asked = near;
    if (near.size() > 1 && n < x.size()) narrow(asked, at, room);
    second.fill(kUnbounded);
    for (const Near& one : asked) {
      const bool first = one.member == asked.front().member;
      members_[one.member]->survey(at, reach, first ? value : other, first ? surroundings : other_around,
                                   std::span(others->unused).first(n));
      if (first) continue;
      for (std::size_t i = 0; i < n; ++i) {
        const double new_one = sign_ * other[i], old_one = sign_ * value[i];
        second[i] = std::min(second[i], std::max(new_one, old_one));
        if (new_one < old_one) value[i] = other[i], surroundings[i] = other_around[i];
      }
    }
    // Other members may be excluded beyond that.
    for (std::size_t i = 0; i < n; ++i)
      surroundings[i].alone =
          std::min(surroundings[i].alone, std::min(second[i] - sign_ * value[i], room) / kDifferenceSlope);
  }
}

double GroupNode::least(double sign, const Vec3& x, double radius) const {
  double bound = far_value(sign, x, radius);
  if (members_.size() > kAskedForLeast || depth() > kDeepForLeast) return bound;
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

std::optional<std::uint32_t> GroupNode::faces(FaceBuilder& builder, const Similarity& map) const {
  return builder.combine(members_, sign_, map);
}

double GroupNode::support_of(const Vec3& n, double sign, bool largest) const {
  // In the directions of the axes members have stored it.
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

}  // namespace sansmesh::inline v1
