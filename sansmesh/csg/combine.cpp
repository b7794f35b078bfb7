// Nodes with children: unions and intersections with their blends, complements, offsets, shells.
#include <algorithm>
#include <cmath>
#include <vector>

#include "sansmesh/csg/solid.h"
#include "sansmesh/csg/solid_node.h"

namespace sansmesh {
namespace {

/// More pairs of pieces than this are one piece together: their creases inside the blend are not resolved.
constexpr std::uint64_t kMaxPairs = 1u << 16;

/// Nodes of primitives that cost more than this use their box to tell how far they are: evaluating them would take
/// longer.
constexpr double kCostly = 10;
/// A survey with reach r need not tell beyond this many r how far a piece is alone. What makes blocks of half edge r
/// has to know it up to half the diagonal and two cells more, at most 3.8 r.
constexpr double kSurveyed = 6;

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
    // The cheaper child goes first: where it is far below what the other can be, the other is not asked.
    const bool swapped = b_->cost() < a_->cost();
    const SolidNode& first = swapped ? *b_ : *a_;
    const SolidNode& second = swapped ? *a_ : *b_;
    first.evaluate(x, values, gradients, active);
    const std::vector<std::uint32_t> wanted = where_to_ask(second, x, values);
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
    // The blend's polynomial goes on beyond its ends: smooth, which the blend with its ends is not.
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double a = values[i], b = other[i];
      values[i] = (a + b) / 2 - sign_ * (radius_ * radius_ + (a - b) * (a - b)) / (4 * radius_);
      if (gradients.empty()) continue;
      const double weight = 0.5 + sign_ * (a - b) / (2 * radius_);
      gradients[i] = (1 - weight) * gradients[i] + weight * slope[i];
    }
  }

  void survey(std::span<const Vec3> x, double reach, std::span<double> values,
              std::span<Surroundings> around) const override {
    const bool swapped = b_->cost() < a_->cost();
    const SolidNode& first = swapped ? *b_ : *a_;
    const SolidNode& second = swapped ? *a_ : *b_;
    first.survey(x, reach, values, around);
    // How fast the difference of both values can change, and with it the weights of both.
    const double slopes = a_->slope() + b_->slope();
    const std::vector<std::uint32_t> wanted = where_to_ask(second, x, values, kSurveyed * reach * slopes);
    std::vector<Vec3> at(wanted.size());
    std::vector<double> value(wanted.size());
    std::vector<Surroundings> other(wanted.size());
    for (std::size_t j = 0; j < wanted.size(); ++j) at[j] = x[wanted[j]];
    if (!at.empty()) second.survey(at, reach, value, other);
    for (std::size_t i = 0, j = 0; i < x.size(); ++i) {
      if (j == wanted.size() || wanted[j] != i) {
        const double gap = least_of(second, x[i]) - sign_ * values[i];
        around[i].alone = std::min(around[i].alone, (gap - radius_) / slopes);
        continue;
      }
      const double gap = sign_ * (value[j] - values[i]);  // below 0: the second one counts
      Surroundings both = {std::min(around[i].alone, other[j].alone), std::min(around[i].detail, other[j].detail)};
      if (std::abs(gap) >= radius_) both = gap >= 0 ? around[i] : other[j];
      both.alone = std::min(both.alone, std::abs(std::abs(gap) - radius_) / slopes);
      around[i] = both;
      values[i] = combined(values[i], value[j]);
      ++j;
    }
  }

  double least(double sign, const Vec3& x) const override {
    const auto least_of_child = [&](const SolidNode& c) {
      return c.lipschitz() && c.cost() > kCostly ? c.far_value(sign, x) : c.least(sign, x);
    };
    const double a = least_of_child(*a_), b = least_of_child(*b_);
    // The value is that of one of both, and blends move it towards the sign of the combination, by a quarter at most.
    const double both = sign == sign_ ? std::min(a, b) - radius_ / 4 : std::max(a, b);
    return std::max(both, far_value(sign, x));
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
    Traits t;
    t.pieces = static_cast<std::uint64_t>(a.pieces()) + b.pieces();
    if (radius > 0) t.pieces += std::max<std::uint64_t>(1, pairs_of(a, b));
    t.rise = std::min(a.rise(), b.rise());
    t.lipschitz = a.lipschitz() && b.lipschitz();
    t.cost = a.cost() + b.cost();
    t.depth = 1 + std::max(a.depth(), b.depth());
    t.thickness = thinner(a.thickness(), b.thickness());
    t.hollow_thickness = thinner(a.hollow_thickness(), b.hollow_thickness());
    return t;
  }

  /// Below nodes whose slopes are not known there are fields: costly ones, which know better than their boxes where
  /// they are far.
  double least_of(const SolidNode& second, const Vec3& x) const {
    return !second.lipschitz() ? second.least(sign_, x) : second.far_value(sign_, x);
  }

  /// All points but those where `second` is so far away that the value of the first is known to be all, by `room` more
  /// than it must be.
  std::vector<std::uint32_t> where_to_ask(const SolidNode& second, std::span<const Vec3> x,
                                          std::span<const double> values, double room = 0) const {
    const bool known = !second.lipschitz() || bounded_anywhere(sign_ > 0 ? second.extents() : second.hollow_extents());
    std::vector<std::uint32_t> wanted;
    wanted.reserve(x.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      if (!known || !(sign_ * values[i] + radius_ + room < least_of(second, x[i])))
        wanted.push_back(static_cast<std::uint32_t>(i));
    return wanted;
  }

  bool pairs() const { return pairs_of(*a_, *b_) > 0; }

  std::uint32_t blend_piece(std::uint32_t a, std::uint32_t b) const {
    return a_->pieces() + b_->pieces() + (pairs() ? a * b_->pieces() + b : 0);
  }

  /// How much of the gradient is that of b: 0 and 1 beyond the blend.
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

  NodePtr a_, b_;
  double sign_, radius_;
};

class ComplementNode final : public SolidNode {
 public:
  explicit ComplementNode(NodePtr child) : SolidNode(traits_of(*child)), child_(std::move(child)) { keep_extents(); }
  const NodePtr& child() const { return child_; }

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                std::span<std::uint32_t> active) const override {
    child_->evaluate(x, values, gradients, active);
    turn(values, gradients);
  }
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override {
    child_->evaluate_piece(piece, x, values, gradients);
    turn(values, gradients);
  }
  void survey(std::span<const Vec3> x, double reach, std::span<double> values,
              std::span<Surroundings> around) const override {
    child_->survey(x, reach, values, around);
    turn(values, {});
  }
  double least(double sign, const Vec3& x) const override { return child_->least(-sign, x); }
  double support(const Vec3& n) const override { return child_->hollow_support(n); }
  double hollow_support(const Vec3& n) const override { return child_->support(n); }

 private:
  static Traits traits_of(const SolidNode& child) {
    Traits t = above(child);
    std::swap(t.thickness, t.hollow_thickness);
    return t;
  }
  static void turn(std::span<double> values, std::span<Vec3> gradients) {
    for (double& v : values) v = -v;
    for (Vec3& g : gradients) g = -g;
  }
  NodePtr child_;
};

/// Bound after moving a surface outward by `distance` (inward if negative).
double moved(const SolidNode& node, double support, double distance) {
  if (distance > 0) return support + distance / node.rise();
  return node.lipschitz() ? support + distance : support;
}

class OffsetNode final : public SolidNode {
 public:
  OffsetNode(NodePtr child, double distance)
      : SolidNode(traits_of(*child, distance)), child_(std::move(child)), distance_(distance) {
    keep_extents();
  }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                std::span<std::uint32_t> active) const override {
    child_->evaluate(x, values, gradients, active);
    for (double& v : values) v -= distance_;
  }
  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override {
    child_->evaluate_piece(piece, x, values, gradients);
    for (double& v : values) v -= distance_;
  }
  void survey(std::span<const Vec3> x, double reach, std::span<double> values,
              std::span<Surroundings> around) const override {
    child_->survey(x, reach, values, around);
    for (double& v : values) v -= distance_;
  }
  double least(double sign, const Vec3& x) const override { return child_->least(sign, x) - sign * distance_; }
  double support(const Vec3& n) const override { return moved(*child_, child_->support(n), distance_); }
  double hollow_support(const Vec3& n) const override { return moved(*child_, child_->hollow_support(n), -distance_); }

 private:
  static Traits traits_of(const SolidNode& child, double distance) {
    Traits t = above(child);
    t.thickness += 2 * distance;
    t.hollow_thickness -= 2 * distance;
    return t;
  }
  NodePtr child_;
  double distance_;
};

/// |f − middle| − half: each piece twice, as the outer and as the inner surface.
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
  void survey(std::span<const Vec3> x, double reach, std::span<double> values,
              std::span<Surroundings> around) const override {
    child_->survey(x, reach, values, around);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double from_middle = std::abs(values[i] - middle_);
      around[i].alone = std::min(around[i].alone, from_middle / child_->slope());
      values[i] = from_middle - half_;
    }
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
    // The wall, or a part or hole of the child within it; and what is left of parts and holes beyond it.
    const double s = child.thickness(), h = child.hollow_thickness();
    t.thickness = thinner(2 * half, thinner(s + 2 * (middle + half), h - 2 * (middle - half)));
    t.hollow_thickness = thinner(s + 2 * (middle - half), h - 2 * (middle + half));
    return t;
  }
  NodePtr child_;
  double middle_, half_;
};

Solid combine(const char* what, NodePtr a, NodePtr b, double sign, double blend) {
  require_finite(what, "r", blend);
  if (blend != 0) require_positive(what, "r", blend);
  if (a == b && blend == 0) return Solid(std::move(a));
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
  if (const auto* twice = dynamic_cast<const ComplementNode*>(a.node().get())) return Solid(twice->child());
  return Solid(std::make_shared<ComplementNode>(a.node()));
}

Solid offset(const Solid& a, double distance) {
  require_finite("offset", "d", distance);
  if (distance == 0) return a;
  return Solid(std::make_shared<OffsetNode>(a.node(), distance));
}

Solid shell(const Solid& a, double thickness, ShellSide side) {
  require_positive("shell", "t", thickness);
  const double half = thickness / 2;
  const double middle = side == ShellSide::inside ? -half : side == ShellSide::outside ? half : 0;
  return Solid(std::make_shared<ShellNode>(a.node(), middle, half));
}

}  // namespace csg
}  // namespace sansmesh
