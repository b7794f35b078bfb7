// Nodes with children: unions and intersections with their blends, complements, offsets, shells.
#include <algorithm>
#include <cmath>
#include <vector>

#include "sansmesh/csg/face_builder.h"
#include "sansmesh/csg/group_node.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/csg/solid_expression.h"
#include "sansmesh/csg/solid_node.h"

namespace sansmesh::inline v1 {
namespace {

/// With more pairs of pieces all are one piece: creases inside the blend are not resolved.
constexpr std::uint64_t kMaxPairs = 1u << 16;

/// More expensive nodes of primitives estimate their distance by their box, because evaluation would take longer.
constexpr double kCostly = 10;

bool bounded_anywhere(const Extents& e) {
  return std::any_of(e.begin(), e.end(), [](double v) { return v < kUnbounded; });
}

/// Union (sign 1) or intersection (sign −1): sign · min(sign a, sign b), blended within `radius`.
class CombineNode final : public SolidNode {
 public:
  CombineNode(NodePtr a, NodePtr b, double sign, double radius)
      : SolidNode(traits_of(*a, *b, radius)), a_(std::move(a)), b_(std::move(b)), sign_(sign), radius_(radius) {
    keep_extents();
  }

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                std::span<std::uint32_t> active) const override {
    // The cheaper child is evaluated first: where its value is far below the bound of the other, the other is skipped.
    const bool swapped = b_->cost() < a_->cost();
    const auto& [first, second] = by_cost();
    first.evaluate(x, values, gradients, active);
    const auto highest = [&](std::size_t i) { return sign_ * values[i] + radius_; };
    const std::vector<std::uint32_t> wanted = where_to_ask(second, x, highest, 0);
    const std::size_t n = wanted.size();
    std::vector<Vec3> at(n), slope(gradients.empty() ? 0 : n);
    std::vector<double> value(n);
    std::vector<std::uint32_t> piece(active.empty() ? 0 : n);
    for (std::size_t j = 0; j < n; ++j) at[j] = x[wanted[j]];
    if (n > 0) second.evaluate(at, value, slope, piece);
    if (swapped && !active.empty() && n < x.size()) {
      for (std::uint32_t& p : active) p += a_->pieces();
      for (const std::uint32_t i : wanted) active[i] -= a_->pieces();
    }
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t i = wanted[j];
      const double a = swapped ? value[j] : values[i], b = swapped ? values[i] : value[j];
      const double weight = weight_of_b(a, b);
      values[i] = combined(a, b);
      if (!gradients.empty()) {
        const Vec3 ga = swapped ? slope[j] : gradients[i], gb = swapped ? gradients[i] : slope[j];
        gradients[i] = weight == 0 ? ga : weight == 1 ? gb : (1 - weight) * ga + weight * gb;
      }
      if (!active.empty()) {
        const std::uint32_t pa = swapped ? piece[j] : active[i], pb = swapped ? active[i] : piece[j];
        active[i] = weight == 0 ? pa : weight == 1 ? a_->pieces() + pb : blend_piece(pa, pb);
      }
    }
  }

  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override {
    const std::uint32_t na = a_->pieces(), nb = b_->pieces();
    if (piece < na) return a_->evaluate_piece(piece, x, values, gradients);
    if (piece < na + nb) return b_->evaluate_piece(piece - na, x, values, gradients);
    std::vector<double> other(x.size());
    std::vector<Vec3> slope(gradients.empty() ? 0 : x.size());
    if (pairs()) {
      a_->evaluate_piece((piece - na - nb) / nb, x, values, gradients);
      b_->evaluate_piece((piece - na - nb) % nb, x, other, slope);
    } else {
      a_->evaluate(x, values, gradients, {});
      b_->evaluate(x, other, slope, {});
    }
    // A piece is the blend's polynomial without its ends, which is smooth beyond them; the blend with its ends is not.
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double a = values[i], b = other[i];
      values[i] = (a + b) / 2 - sign_ * (radius_ * radius_ + (a - b) * (a - b)) / (4 * radius_);
      if (gradients.empty()) continue;
      const double weight = 0.5 + sign_ * (a - b) / (2 * radius_);
      gradients[i] = (1 - weight) * gradients[i] + weight * slope[i];
    }
  }

  void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
              std::span<Surroundings> around, std::span<ValueRange> ranges) const override {
    const auto& [first, second] = by_cost();
    first.survey(x, reach, values, around, ranges);
    // Difference of the values for which the second is irrelevant: within the reach each changes by at most that, or is
    // in its range.
    const double room = lipschitz() ? kSurveyed * reach.detail * kDifferenceSlope : 0;
    if (!lipschitz()) by_slope(first, values, reach.alone, ranges);
    const auto highest = [&](std::size_t i) {
      return lipschitz() ? sign_ * values[i] + radius_ + room : turned(ranges[i]).most + radius_;
    };
    const std::vector<std::uint32_t> wanted = where_to_ask(second, x, highest, lipschitz() ? 0 : reach.alone);
    std::vector<Vec3> at(wanted.size());
    std::vector<double> value(wanted.size());
    std::vector<Surroundings> other(wanted.size());
    std::vector<ValueRange> other_range(lipschitz() ? 0 : wanted.size());
    for (std::size_t j = 0; j < wanted.size(); ++j) at[j] = x[wanted[j]];
    if (!at.empty()) second.survey(at, reach, value, other, other_range);
    if (!lipschitz()) by_slope(second, value, reach.alone, other_range);
    for (std::size_t i = 0, j = 0; i < x.size(); ++i) {
      if (j == wanted.size() || wanted[j] != i) {
        if (!lipschitz()) continue;
        const double gap = least_of(second, x[i], 0) - sign_ * values[i];
        around[i].alone = std::min(around[i].alone, (gap - radius_) / kDifferenceSlope);
        continue;
      }
      const double gap = sign_ * (value[j] - values[i]);  // below 0: the second one dominates
      Surroundings both = {std::min(around[i].alone, other[j].alone), std::min(around[i].detail, other[j].detail)};
      if (std::abs(gap) >= radius_) both = gap >= 0 ? around[i] : other[j];
      if (lipschitz()) {
        both.alone = std::min(both.alone, std::abs(std::abs(gap) - radius_) / kDifferenceSlope);
      } else {
        if (!apart(ranges[i], other_range[j])) both.alone = 0;
        ranges[i] = combined(ranges[i], other_range[j]);
      }
      around[i] = both;
      values[i] = combined(values[i], value[j]);
      ++j;
    }
  }

  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override {
    if (lipschitz()) return SolidNode::ranges(x, radius, found);
    const auto& [first, second] = by_cost();
    first.ranges(x, radius, found);
    const auto highest = [&](std::size_t i) { return turned(found[i]).most + radius_; };
    const std::vector<std::uint32_t> wanted = where_to_ask(second, x, highest, radius);
    std::vector<Vec3> at(wanted.size());
    std::vector<ValueRange> other(wanted.size());
    for (std::size_t j = 0; j < wanted.size(); ++j) at[j] = x[wanted[j]];
    if (!at.empty()) second.ranges(at, radius, other);
    for (std::size_t j = 0; j < wanted.size(); ++j) found[wanted[j]] = combined(found[wanted[j]], other[j]);
  }

  double least(double sign, const Vec3& x, double radius) const override {
    if (depth() > kDeepForLeast) return far_value(sign, x, radius);
    const auto least_of_child = [&](const SolidNode& c) {
      return c.lipschitz() && c.cost() > kCostly ? c.far_value(sign, x, radius) : c.least(sign, x, radius);
    };
    const double a = least_of_child(*a_), b = least_of_child(*b_);
    // The value is one of both, and blends move it towards the sign of the combination by at most a quarter of the
    // radius.
    const double both = sign == sign_ ? std::min(a, b) - radius_ / 4 : std::max(a, b);
    return std::max(both, far_value(sign, x, radius));
  }

  std::optional<std::uint32_t> express(ExpressionBuilder& builder, const ExpressionFrame& frame) const override {
    return builder.combine(*a_, *b_, sign_, radius_, frame);
  }
  std::optional<std::uint32_t> faces(FaceBuilder& builder, const Similarity& map) const override {
    if (radius_ > 0) return builder.refuse("a rounded crease (r=)");
    return builder.combine({a_, b_}, sign_, map);
  }

  double support(const Vec3& n) const override {
    const double a = a_->support(n), b = b_->support(n);
    return sign_ > 0 ? std::max(a, b) + radius_ / (4 * rise()) : std::min(a, b);
  }
  double hollow_support(const Vec3& n) const override {
    const double a = a_->hollow_support(n), b = b_->hollow_support(n);
    return sign_ > 0 ? std::min(a, b) : std::max(a, b) + radius_ / (4 * rise());
  }

 private:
  static std::uint64_t pairs_of(const SolidNode& a, const SolidNode& b) {
    const std::uint64_t pairs = static_cast<std::uint64_t>(a.pieces()) * b.pieces();
    return pairs > kMaxPairs ? 0 : pairs;
  }

  static Traits traits_of(const SolidNode& a, const SolidNode& b, double radius) {
    Traits t = above(a);
    t.join(b);
    if (radius > 0) t.pieces += std::max<std::uint64_t>(1, pairs_of(a, b));
    t.magnitude += radius;
    return t;
  }

  /// Nodes without known slopes contain fields, which are expensive and have better bounds than their boxes.
  double least_of(const SolidNode& second, const Vec3& x, double radius) const {
    return !second.lipschitz() ? second.least(sign_, x, radius) : second.far_value(sign_, x, radius);
  }

  /// Indices of all points except those where `second` is so far away that the value of the first is known to be the
  /// result, within `radius`. highest(i) is the bound that the second's sign times values must exceed.
  template <class Highest>
  std::vector<std::uint32_t> where_to_ask(const SolidNode& second, std::span<const Vec3> x, const Highest& highest,
                                          double radius) const {
    const bool known = !second.lipschitz() || bounded_anywhere(sign_ > 0 ? second.extents() : second.hollow_extents());
    std::vector<std::uint32_t> wanted;
    wanted.reserve(x.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      if (!known || !(highest(i) + value_rounding(second, x[i], radius) < least_of(second, x[i], radius)))
        wanted.push_back(static_cast<std::uint32_t>(i));
    return wanted;
  }

  /// Ranges of a child with known slope, within `radius`; those of others are already set.
  static void by_slope(const SolidNode& child, std::span<const double> values, double radius,
                       std::span<ValueRange> ranges) {
    if (!child.lipschitz()) return;
    for (std::size_t i = 0; i < values.size(); ++i) ranges[i] = {values[i] - radius, values[i] + radius};
  }

  /// With the sign reversed for intersections.
  ValueRange turned(const ValueRange& r) const { return sign_ > 0 ? r : ValueRange{-r.most, -r.least}; }
  /// Whether one of both is irrelevant for all values in the ranges.
  bool apart(const ValueRange& a, const ValueRange& b) const {
    return turned(a).most + radius_ < turned(b).least || turned(b).most + radius_ < turned(a).least;
  }

  /// The children, the cheaper one first.
  std::pair<const SolidNode&, const SolidNode&> by_cost() const {
    if (b_->cost() < a_->cost()) return {*b_, *a_};
    return {*a_, *b_};
  }

  bool pairs() const { return pairs_of(*a_, *b_) > 0; }

  std::uint32_t blend_piece(std::uint32_t a, std::uint32_t b) const {
    return a_->pieces() + b_->pieces() + (pairs() ? a * b_->pieces() + b : 0);
  }

  /// Weight of b's gradient: 0 or 1 beyond the blend.
  double weight_of_b(double a, double b) const {
    const double d = sign_ * (a - b);
    if (radius_ > 0 && std::abs(d) < radius_) return 0.5 + d / (2 * radius_);
    return d <= 0 ? 0 : 1;
  }

  double combined(double a, double b) const {
    const double d = a - b;
    if (radius_ > 0 && std::abs(d) < radius_) return (a + b) / 2 - sign_ * (radius_ * radius_ + d * d) / (4 * radius_);
    return sign_ > 0 ? std::min(a, b) : std::max(a, b);
  }
  /// Monotonic in both.
  ValueRange combined(const ValueRange& a, const ValueRange& b) const {
    return {combined(a.least, b.least), combined(a.most, b.most)};
  }

  NodePtr a_, b_;
  double sign_, radius_;
};

/// Bound after moving a surface outward by `distance` (inward if negative).
double moved(const SolidNode& node, double support, double distance) {
  if (distance > 0) return support + distance / node.rise();
  return node.lipschitz() ? support + distance : support;
}

/// Frame of a child whose values enter as side · (child − distance).
ExpressionFrame offset_frame(const ExpressionFrame& frame, double side, double distance) {
  ExpressionFrame inner = frame;
  inner.sign = frame.sign * side;
  inner.shift -= inner.sign * frame.map.scale * distance;
  return inner;
}

/// side · (child − distance): a complement (side −1, distance 0) or an offset (side 1).
class SidedNode final : public SolidNode {
 public:
  SidedNode(NodePtr child, double side, double distance)
      : SolidNode(traits_of(*child, side, distance)), child_(std::move(child)), side_(side), distance_(distance) {
    keep_extents();
  }
  const NodePtr& child() const { return child_; }
  bool is_complement() const { return side_ < 0; }

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                std::span<std::uint32_t> active) const override {
    child_->evaluate(x, values, gradients, active);
    apply(values, gradients);
  }
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override {
    child_->evaluate_piece(piece, x, values, gradients);
    apply(values, gradients);
  }
  void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
              std::span<Surroundings> around, std::span<ValueRange> ranges) const override {
    child_->survey(x, reach, values, around, ranges);
    apply(values, {});
    apply(ranges);
  }
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override {
    child_->ranges(x, radius, found);
    apply(found);
  }
  double least(double sign, const Vec3& x, double radius) const override {
    return child_->least(sign * side_, x, radius) - sign * distance_;
  }
  std::optional<std::uint32_t> express(ExpressionBuilder& builder, const ExpressionFrame& frame) const override {
    return child_->express(builder, offset_frame(frame, side_, distance_));
  }
  std::optional<std::uint32_t> faces(FaceBuilder& builder, const Similarity& map) const override {
    if (distance_ != 0) return builder.refuse("an offset");
    const auto inner = child_->faces(builder, map);
    if (!inner) return std::nullopt;
    return builder.expression.combine(BooleanExpression::Kind::complement, {*inner});
  }
  double support(const Vec3& n) const override {
    return moved(*child_, side_ > 0 ? child_->support(n) : child_->hollow_support(n), distance_);
  }
  double hollow_support(const Vec3& n) const override {
    return moved(*child_, side_ > 0 ? child_->hollow_support(n) : child_->support(n), -distance_);
  }

 private:
  static Traits traits_of(const SolidNode& child, double side, double distance) {
    Traits t = above(child);
    if (side < 0) std::swap(t.thickness, t.hollow_thickness);
    t.thickness += 2 * distance;
    t.hollow_thickness -= 2 * distance;
    t.magnitude += std::abs(distance);
    return t;
  }
  void apply(std::span<double> values, std::span<Vec3> gradients) const {
    for (double& v : values) v = side_ * (v - distance_);
    if (side_ < 0)
      for (Vec3& g : gradients) g = -g;
  }
  void apply(std::span<ValueRange> ranges) const {
    for (ValueRange& r : ranges) {
      r = {r.least - distance_, r.most - distance_};
      if (side_ < 0) r = {-r.most, -r.least};
    }
  }
  NodePtr child_;
  double side_, distance_;
};

/// |f − middle| − half: each piece occurs twice, on the outer and on the inner surface.
class ShellNode final : public SolidNode {
 public:
  ShellNode(NodePtr child, double middle, double half)
      : SolidNode(traits_of(*child, middle, half)), child_(std::move(child)), middle_(middle), half_(half) {
    keep_extents();
  }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                std::span<std::uint32_t> active) const override {
    child_->evaluate(x, values, gradients, active);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const bool inner = values[i] < middle_;
      values[i] = std::abs(values[i] - middle_) - half_;
      if (inner && !gradients.empty()) gradients[i] = -gradients[i];
      if (inner && !active.empty()) active[i] += child_->pieces();
    }
  }
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override {
    const bool inner = piece >= child_->pieces();
    child_->evaluate_piece(inner ? piece - child_->pieces() : piece, x, values, gradients);
    const double sign = inner ? -1 : 1;
    for (double& v : values) v = sign * (v - middle_) - half_;
    if (inner)
      for (Vec3& g : gradients) g = -g;
  }
  void survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
              std::span<Surroundings> around, std::span<ValueRange> ranges) const override {
    child_->survey(x, reach, values, around, ranges);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double from_middle = std::abs(values[i] - middle_);
      if (lipschitz()) {
        around[i].alone = std::min(around[i].alone, from_middle);
      } else if (ranges[i].least <= middle_ && ranges[i].most >= middle_) {
        around[i].alone = 0;
      }
      values[i] = from_middle - half_;
    }
    if (!lipschitz()) fold(ranges);
  }
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override {
    child_->ranges(x, radius, found);
    fold(found);
  }
  /// The child grown by the outer distance, minus the child grown by the inner one.
  std::optional<std::uint32_t> express(ExpressionBuilder& builder, const ExpressionFrame& frame) const override {
    const ExpressionBuilder::WithinShell within(builder);
    const auto outer = child_->express(builder, offset_frame(frame, 1, middle_ + half_));
    if (!outer || builder.full()) return std::nullopt;  // each nesting of shells doubles the nodes
    const auto inner = child_->express(builder, offset_frame(frame, -1, middle_ - half_));
    if (!inner) return std::nullopt;
    using Kind = ExpressionBuilder::Node::Kind;
    return builder.combine(frame.sign > 0 ? Kind::greatest : Kind::least, *outer, *inner);
  }
  std::optional<std::uint32_t> faces(FaceBuilder& builder, const Similarity&) const override {
    return builder.refuse("a shell");
  }
  double support(const Vec3& n) const override {
    return std::min(moved(*child_, child_->support(n), middle_ + half_),
                    moved(*child_, child_->hollow_support(n), half_ - middle_));
  }
  double hollow_support(const Vec3&) const override { return kUnbounded; }

 private:
  static Traits traits_of(const SolidNode& child, double middle, double half) {
    Traits t = above(child);
    t.pieces *= 2;
    t.magnitude += std::abs(middle) + half;
    // The wall, or a part or hole of the child within it; and the remainder of parts and holes beyond it.
    const double s = child.thickness(), h = child.hollow_thickness();
    t.thickness = thinner(2 * half, thinner(s + 2 * (middle + half), h - 2 * (middle - half)));
    t.hollow_thickness = thinner(s + 2 * (middle - half), h - 2 * (middle + half));
    return t;
  }
  void fold(std::span<ValueRange> ranges) const {
    for (ValueRange& r : ranges) {
      const double a = std::abs(r.least - middle_), b = std::abs(r.most - middle_);
      const bool both_sides = r.least <= middle_ && r.most >= middle_;
      r = {(both_sides ? 0 : std::min(a, b)) - half_, std::max(a, b) - half_};
    }
  }
  NodePtr child_;
  double middle_, half_;
};

Solid combine(const char* what, NodePtr a, NodePtr b, double sign, double blend) {
  require_finite(what, "r", blend);
  if (blend != 0) require_positive(what, "r", blend);
  if (a == b && blend == 0) return Solid(std::move(a));
  if (a->lipschitz() && b->lipschitz() && blend == 0) return Solid(group_of(a, b, sign));
  return Solid(std::make_shared<CombineNode>(std::move(a), std::move(b), sign, blend));
}

}  // namespace

namespace csg {

Solid unite(const Solid& a, const Solid& b, double blend) { return combine("union", a.node(), b.node(), 1, blend); }

Solid intersect(const Solid& a, const Solid& b, double blend) {
  return combine("intersection", a.node(), b.node(), -1, blend);
}

Solid subtract(const Solid& a, const Solid& b, double blend) {
  return combine("difference", a.node(), complement(b).node(), -1, blend);
}

Solid complement(const Solid& a) {
  const auto* inner = dynamic_cast<const SidedNode*>(a.node().get());
  if (inner && inner->is_complement()) return Solid(inner->child());
  return Solid(std::make_shared<SidedNode>(a.node(), -1, 0));
}

Solid offset(const Solid& a, double distance) {
  require_finite("offset", "d", distance);
  if (distance == 0) return a;
  return Solid(std::make_shared<SidedNode>(a.node(), 1, distance));
}

Solid shell(const Solid& a, double thickness, ShellSide side) {
  require_positive("shell", "t", thickness);
  const double half = thickness / 2;
  const double middle = side == ShellSide::inside ? -half : side == ShellSide::outside ? half : 0;
  return Solid(std::make_shared<ShellNode>(a.node(), middle, half));
}

}  // namespace csg
}  // namespace sansmesh::inline v1
