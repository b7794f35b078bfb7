#include "sansmesh/csg/solid_expression.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sansmesh/csg/solid.h"

namespace sansmesh {
namespace {

using NodeKind = PieceExpression::Node::Kind;

/// More functions than this are too many to be looked at one by one.
constexpr std::size_t kMostFunctions = 1u << 18;
/// Points that go through a function together.
constexpr std::size_t kAtOnce = 64;
/// Planes no farther from each other than this share of the tie are one.
constexpr double kSamePlane = 0.01;
/// Of no particular direction: where functions are asked whether they are planes, and what planes are sorted by.
constexpr Vec3 kAnywhere{0.5772156649, 0.3275822918, -0.6931471806},
    kElsewhere{-0.4142135624, 0.8346268417, 0.2360679775};

Box3 box_of(const SolidNode& root) {
  const Extents& e = root.extents();
  return {{-e[0], -e[2], -e[4]}, {e[1], e[3], e[5]}};
}

/// Of up to kAtOnce points; not of blends.
void evaluate_function(const ExpressionBuilder::Function& f, const Vec3* x, std::size_t n, double* values,
                       Vec3* gradients) {
  std::array<Vec3, kAtOnce> at;
  for (std::size_t i = 0; i < n; ++i) at[i] = f.frame.map.back(x[i]);
  const std::span<const Vec3> places(at.data(), n);
  const std::span<double> found(values, n);
  const std::span<Vec3> slopes(gradients, gradients ? n : 0);
  if (f.piece == kWholeNode) {
    f.node->evaluate(places, found, slopes, {});
  } else {
    f.node->evaluate_piece(f.piece, places, found, slopes);
  }
  const double factor = f.frame.sign * f.frame.map.scale;
  for (std::size_t i = 0; i < n; ++i) values[i] = factor * values[i] + f.frame.shift;
  if (gradients)
    for (std::size_t i = 0; i < n; ++i) gradients[i] = f.frame.sign * f.frame.map.turn(gradients[i]);
}

class SolidExpression final : public PieceExpression {
 public:
  SolidExpression(std::shared_ptr<const SolidNode> root, ExpressionBuilder built) : root_(std::move(root)) {
    nodes_ = std::move(built.nodes);
    all_ = std::move(built.functions);
  }

  Box3 bounds() const override { return box_of(*root_); }
  std::uint32_t pieces() const override { return static_cast<std::uint32_t>(all_.size()); }

  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override {
    for (std::size_t i = 0; i < x.size(); i += kAtOnce) {
      const std::size_t n = std::min(kAtOnce, x.size() - i);
      ask(piece, x.data() + i, n, values.data() + i, gradients.empty() ? nullptr : gradients.data() + i);
    }
  }

  double bend(std::uint32_t piece, const Vec3& x, double radius) const override {
    return bend_of(piece, x, radius, 0, 0);
  }

  bool bends_one_way(std::uint32_t piece) const override {
    return all_[piece].node && all_[piece].node->bends_one_way();
  }

  std::uint32_t same_at(std::uint32_t piece, std::span<const Vec3> x) const override {
    while (!all_[piece].node) {
      int side = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const int here = side_of(piece, x[i], 0);
        if (here == 0 || (i > 0 && here != side)) return piece;
        side = here;
      }
      piece = side < 0 ? all_[piece].a : all_[piece].b;
    }
    return piece;
  }

  std::uint32_t same_within(std::uint32_t piece, const Vec3& x, double radius) const override {
    while (!all_[piece].node) {
      const int side = side_of(piece, x, radius);
      if (side == 0) return piece;
      piece = side < 0 ? all_[piece].a : all_[piece].b;
    }
    return piece;
  }

 private:
  using Function = ExpressionBuilder::Function;

  void ask(std::uint32_t function, const Vec3* x, std::size_t n, double* values, Vec3* gradients) const {
    const Function& f = all_[function];
    if (f.node) {
      evaluate_function(f, x, n, values, gradients);
      return;
    }
    std::array<double, kAtOnce> other;
    std::array<Vec3, kAtOnce> slope;
    ask(f.a, x, n, values, gradients);
    ask(f.b, x, n, other.data(), gradients ? slope.data() : nullptr);
    for (std::size_t i = 0; i < n; ++i) {
      const double a = values[i], b = other[i], d = a - b;
      if (std::abs(d) < f.radius) {
        values[i] = (a + b) / 2 - f.sign * (f.radius * f.radius + d * d) / (4 * f.radius);
        const double weight = 0.5 + f.sign * d / (2 * f.radius);
        if (gradients) gradients[i] = (1 - weight) * gradients[i] + weight * slope[i];
      } else if (f.sign * d > 0) {
        values[i] = b;
        if (gradients) gradients[i] = slope[i];
      }
    }
  }

  /// Which one of both a blend is, within `radius` of x: the first (−1), the second (1) or neither.
  int side_of(std::uint32_t blend, const Vec3& x, double radius) const {
    const Function& f = all_[blend];
    double a = 0, b = 0;
    ask(f.a, &x, 1, &a, nullptr);
    ask(f.b, &x, 1, &b, nullptr);
    const double d = f.sign * (a - b), room = radius > 0 ? 2.0001 * radius : 0;
    return std::abs(d) < f.radius + room ? 0 : d < 0 ? -1 : 1;
  }

  /// Where the function is between two values.
  double bend_of(std::uint32_t function, const Vec3& x, double radius, double least, double most) const {
    const Function& f = all_[function];
    if (f.node) {
      const double factor = f.frame.sign * f.frame.map.scale;
      const double level = ((factor > 0 ? least : most) - f.frame.shift) / factor;
      return f.node->bend(f.piece, f.frame.map.back(x), radius / f.frame.map.scale, level) / f.frame.map.scale;
    }
    const int side = side_of(function, x, radius);
    if (side != 0) return bend_of(side < 0 ? f.a : f.b, x, radius, least, most);
    double a = 0, b = 0;
    Vec3 ga, gb;
    ask(f.a, &x, 1, &a, &ga);
    ask(f.b, &x, 1, &b, &gb);
    // Both are no farther from the value of the blend than its radius, to the side to which it leaves them.
    const double low = least - (f.sign < 0 ? f.radius : 0), high = most + (f.sign > 0 ? f.radius : 0);
    const double of_a = bend_of(f.a, x, radius, std::max(low, a - radius), std::min(high, a + radius));
    const double of_b = bend_of(f.b, x, radius, std::max(low, b - radius), std::min(high, b + radius));
    const double apart = std::min(2.0, norm(ga - gb) + (of_a + of_b) * radius);
    return std::max(of_a, of_b) + apart * apart / (2 * f.radius);
  }

  std::shared_ptr<const SolidNode> root_;
  std::vector<Function> all_;
};

}  // namespace

ExpressionBuilder::ExpressionBuilder(double tie, const Box3& box) : tie_(tie) {
  if (box.empty() || !is_finite(box.lower) || !is_finite(box.upper)) return;
  middle_ = box.center(), radius_ = box.diagonal() / 2;
}

std::optional<ExpressionBuilder::Plane> ExpressionBuilder::plane_of(const Function& function) const {
  const std::array<Vec3, 3> x{middle_, middle_ + kAnywhere * radius_, middle_ + kElsewhere * radius_};
  const double factor = function.frame.sign * function.frame.map.scale, level = -function.frame.shift / factor;
  for (const Vec3& at : x)
    if (function.node->bend(function.piece, function.frame.map.back(at), 0, level) > 0) return std::nullopt;
  std::array<double, 3> value{};
  std::array<Vec3, 3> gradient;
  evaluate_function(function, x.data(), x.size(), value.data(), gradient.data());
  for (std::size_t k = 1; k < x.size(); ++k) {
    const double off = value[k] - value[0] - dot(gradient[0], x[k] - x[0]);
    if (!(norm(gradient[k] - gradient[0]) * radius_ + std::abs(off) < kSamePlane * tie_)) return std::nullopt;
  }
  return Plane{value[0], gradient[0], 0};
}

std::uint32_t ExpressionBuilder::add(const Node& node) {
  nodes.push_back(node);
  return static_cast<std::uint32_t>(nodes.size() - 1);
}

std::uint32_t ExpressionBuilder::piece(const SolidNode& node, std::uint32_t number, const ExpressionFrame& frame) {
  Function function;
  function.node = &node, function.piece = number, function.frame = frame;
  // Where many solids have a face in the same plane, as many pieces would meet all over it.
  if (std::optional<Plane> plane = radius_ > 0 ? plane_of(function) : std::nullopt) {
    const double key = plane->value + radius_ * dot(plane->gradient, kAnywhere), near = kSamePlane * tie_;
    for (auto p = planes_.lower_bound(key - near); p != planes_.end() && p->first <= key + near; ++p)
      if (std::abs(p->second.value - plane->value) + radius_ * norm(p->second.gradient - plane->gradient) <= near)
        return add({NodeKind::piece, p->second.function, 0});
    plane->function = static_cast<std::uint32_t>(functions.size());
    planes_.emplace(key, *plane);
  }
  functions.push_back(function);
  // Pieces of two solids that are the same but for this are never in the same place.
  const double share = static_cast<double>(functions.size() * 0x9e3779b1u % 1024u) / 1024;
  functions.back().frame.shift += 0.25 * tie_ * share;
  return add({NodeKind::piece, static_cast<std::uint32_t>(functions.size() - 1), 0});
}

std::uint32_t ExpressionBuilder::combine(Node::Kind kind, std::uint32_t a, std::uint32_t b) {
  return add({kind, a, b});
}

std::uint32_t ExpressionBuilder::pieces(const SolidNode& node, std::uint32_t count, const ExpressionFrame& frame) {
  if (count == 0) return piece(node, kWholeNode, frame);
  const NodeKind kind = frame.sign > 0 ? NodeKind::greatest : NodeKind::least;
  std::uint32_t all = piece(node, 0, frame);
  for (std::uint32_t p = 1; p < count; ++p) all = combine(kind, all, piece(node, p, frame));
  return all;
}

ExpressionFrame ExpressionBuilder::frame_of_parts(const ExpressionFrame& frame, double side) const {
  // Surfaces that coincide: parts of a union overlap, those of an intersection leave a gap.
  ExpressionFrame inner = frame;
  inner.shift -= side * tie_;
  return inner;
}

std::optional<std::uint32_t> ExpressionBuilder::combine(const std::vector<NodePtr>& members, double sign,
                                                        const ExpressionFrame& frame) {
  const double side = sign * frame.sign;
  const ExpressionFrame inner = frame_of_parts(frame, side);
  std::vector<std::uint32_t> roots;
  for (const NodePtr& m : members) {
    const std::optional<std::uint32_t> root = m->express(*this, inner);
    if (!root || functions.size() > kMostFunctions) return std::nullopt;
    roots.push_back(*root);
  }
  while (roots.size() > 1) {  // a balanced tree
    std::size_t kept = 0;
    for (std::size_t i = 0; i < roots.size(); i += 2)
      roots[kept++] = i + 1 < roots.size()
                          ? combine(side > 0 ? NodeKind::least : NodeKind::greatest, roots[i], roots[i + 1])
                          : roots[i];
    roots.resize(kept);
  }
  return roots[0];
}

std::optional<std::uint32_t> ExpressionBuilder::combine(const SolidNode& a, const SolidNode& b, double sign,
                                                        double radius, const ExpressionFrame& frame) {
  const double side = sign * frame.sign;
  const NodeKind kind = side > 0 ? NodeKind::least : NodeKind::greatest;
  const ExpressionFrame inner = frame_of_parts(frame, side);
  const std::size_t before = nodes.size();
  const std::optional<std::uint32_t> first = a.express(*this, inner);
  if (!first) return std::nullopt;
  const std::size_t middle = nodes.size();
  const std::optional<std::uint32_t> second = b.express(*this, inner);
  if (!second || functions.size() > kMostFunctions) return std::nullopt;
  if (radius == 0) return combine(kind, *first, *second);

  // A blend grows with both values: of minima and maxima it is minima and maxima of blends, one for each pair of
  // functions.
  const std::vector<Node> of_a(nodes.begin() + static_cast<std::ptrdiff_t>(before),
                               nodes.begin() + static_cast<std::ptrdiff_t>(middle));
  const std::vector<Node> of_b(nodes.begin() + static_cast<std::ptrdiff_t>(middle), nodes.end());
  nodes.resize(before);
  if (of_a.size() * of_b.size() > kMostFunctions) return std::nullopt;
  const auto copied = [&](const std::vector<Node>& from, std::size_t offset, auto&& leaf) {
    std::vector<std::uint32_t> at(from.size());
    for (std::size_t k = 0; k < from.size(); ++k)
      at[k] = from[k].kind == NodeKind::piece ? leaf(from[k].a)
                                              : add({from[k].kind, at[from[k].a - offset], at[from[k].b - offset]});
    return at.back();
  };
  return copied(of_a, before, [&](std::uint32_t f) {
    return copied(of_b, middle, [&](std::uint32_t g) {
      Function blend;
      blend.a = f, blend.b = g, blend.radius = radius * frame.map.scale, blend.sign = side;
      functions.push_back(blend);
      return add({NodeKind::piece, static_cast<std::uint32_t>(functions.size() - 1), 0});
    });
  });
}

std::shared_ptr<const PieceExpression> expression_of(std::shared_ptr<const SolidNode> root, double tie) {
  ExpressionBuilder builder(tie, box_of(*root));
  if (!root->express(builder, {})) return nullptr;
  return std::make_shared<SolidExpression>(std::move(root), std::move(builder));
}

std::shared_ptr<const PieceExpression> Solid::expression(double tie) const { return expression_of(node_, tie); }

}  // namespace sansmesh
