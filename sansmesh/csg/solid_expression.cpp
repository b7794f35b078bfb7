#include "sansmesh/csg/solid_expression.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/csg/solid.h"

namespace sansmesh::inline v1 {
namespace {

using NodeKind = PieceExpression::Node::Kind;

/// Limit of the number of functions of an expression.
constexpr std::size_t kMostFunctions = 1u << 18;
/// Limit of nodes. Faces in one plane are one function in many nodes.
constexpr std::size_t kMostNodes = 4 * kMostFunctions;
/// With this many nested shells, and this ratio of nodes to functions, equal parts are merged.
constexpr int kManyShells = 4;
constexpr std::size_t kManyNodes = 8;
/// Number of points evaluated together by a function.
constexpr std::size_t kAtOnce = 64;
/// Planes closer than this share of the tie are merged.
constexpr double kSamePlane = 0.01;
/// A generic direction for sorting planes.
constexpr Vec3 kAnywhere{0.5772156649, 0.3275822918, -0.6931471806};
/// Tie of a part, as a share of its parent's if one is a union and the other an intersection, and its least share of
/// the first tie; and the share of the tie by which otherwise equal functions differ.
constexpr double kTieOfPart = 0.5, kLeastTie = 1.0 / 16, kTieOfFunction = 0.25;
/// Lipschitz constant of the difference of two values whose slopes are at most 1, with a margin.
constexpr double kRoomPerRadius = 2.0001;
/// Blends of more parts are resolved by regions. Division ends at regions with few parts, at a size relative to the
/// radius, or after a number of halvings. A region is valid in a ball of kBallOfRegion edges (0.87 contain its
/// corners).
constexpr std::size_t kManyBlended = 8, kFewBlended = 6;
constexpr double kLeastRegion = 0.5, kBallOfRegion = 1.75;
constexpr int kMostHalvings = 10;
constexpr std::size_t kMostRegions = 1u << 18;

Box3 box_of(const SolidNode& root) {
  const Extents& e = root.extents();
  return {{-e[0], -e[2], -e[4]}, {e[1], e[3], e[5]}};
}

/// Evaluates up to kAtOnce points; not for blends.
void evaluate_function(const ExpressionBuilder::Function& f, const Vec3* x, std::size_t n, double* values,
                       Vec3* gradients) {
  std::array<Vec3, kAtOnce> at;
  for (std::size_t i = 0; i < n; ++i) at[i] = f.frame.map.back(x[i]);
  const std::span<const Vec3> inner(at.data(), n);
  const std::span<double> found(values, n);
  const std::span<Vec3> slopes(gradients, gradients ? n : 0);
  if (f.piece == kWholeNode) {
    f.node->evaluate(inner, found, slopes, {});
  } else {
    f.node->evaluate_piece(f.piece, inner, found, slopes);
  }
  const double factor = f.frame.sign * f.frame.map.scale;
  for (std::size_t i = 0; i < n; ++i) values[i] = factor * values[i] + f.frame.shift;
  if (gradients)
    for (std::size_t i = 0; i < n; ++i) gradients[i] = f.frame.sign * f.frame.map.rotate(gradients[i]);
}

class SolidExpression final : public PieceExpression {
 public:
  SolidExpression(std::shared_ptr<const SolidNode> root, ExpressionBuilder built) : root_(std::move(root)) {
    nodes_ = std::move(built.nodes);
    all_ = std::move(built.functions);
    pieces_ = static_cast<std::uint32_t>(all_.size());
    divide();
  }

  Box3 bounds() const override { return box_of(*root_); }
  std::uint32_t pieces() const override { return pieces_; }

  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override {
    const bool divided = region_of_[piece] != kNowhere;
    for (std::size_t i = 0, n = 0; i < x.size(); i += n) {
      const std::uint32_t here = divided ? near(piece, x[i], 0) : piece;
      n = std::min(kAtOnce, x.size() - i);
      if (divided)
        for (std::size_t k = 1; k < n; ++k)
          if (near(piece, x[i + k], 0) != here) n = k;
      ask(here, x.data() + i, n, values.data() + i, gradients.empty() ? nullptr : gradients.data() + i);
    }
  }

  double curvature_bound(std::uint32_t piece, const Vec3& x, double radius) const override {
    return curvature_bound_of(near(piece, x, radius), x, radius, 0, 0);
  }

  bool singly_curved(std::uint32_t piece) const override {
    return all_[piece].node && all_[piece].node->singly_curved();
  }

  std::uint32_t same_at(std::uint32_t piece, std::span<const Vec3> x) const override {
    if (x.empty()) return piece;
    double around = 0;
    for (const Vec3& y : x) around = std::max(around, norm(y - x[0]));
    const std::uint32_t here = near(piece, x[0], 0);
    const bool together = std::all_of(x.begin(), x.end(), [&](const Vec3& y) { return near(piece, y, 0) == here; });
    piece = together ? here : near(piece, x[0], around);
    while (!all_[piece].node) {
      int side = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const int own = side_of(piece, x[i], 0);
        if (own == 0 || (i > 0 && own != side)) return origin(piece);
        side = own;
      }
      piece = side < 0 ? all_[piece].a : all_[piece].b;
    }
    return origin(piece);
  }

  std::uint32_t same_within(std::uint32_t piece, const Vec3& x, double radius) const override {
    piece = near(piece, x, radius);
    while (!all_[piece].node) {
      const int side = side_of(piece, x, radius);
      if (side == 0) return origin(piece);
      piece = side < 0 ? all_[piece].a : all_[piece].b;
    }
    return origin(piece);
  }

 private:
  using Function = ExpressionBuilder::Function;
  static constexpr std::uint32_t kNowhere = ~std::uint32_t{0};

  /// A cube, and a simplified blend that equals a blend of many parts in the ball around it to the last digit: parts
  /// too far away are omitted.
  struct Region {
    Vec3 center;
    double edge = 0;
    std::uint32_t function = 0;
    std::uint32_t child = kNowhere;  ///< first of eight children
  };

  struct Local {
    std::uint32_t function;
    double value;
  };

  /// A blend of two functions that replace those of `f`.
  std::uint32_t stand_in(std::uint32_t f, std::uint32_t a, std::uint32_t b) {
    const auto [known, is_new] = stand_ins_.try_emplace({origin(f), a, b}, static_cast<std::uint32_t>(all_.size()));
    if (is_new) {
      Function blend = all_[f];
      blend.a = a, blend.b = b;
      all_.push_back(blend);
      origin_.push_back(origin(f));
    }
    return known->second;
  }

  /// Simplification of `function` within `radius` of x, and its value there, like side_of() for all its parts.
  Local within(std::uint32_t function, const Vec3& x, double radius) {
    const Function f = all_[function];
    if (f.node) {
      Local here{function, 0};
      ask(function, &x, 1, &here.value, nullptr);
      return here;
    }
    const Local a = within(f.a, x, radius), b = within(f.b, x, radius);
    const double d = f.sign * (a.value - b.value);
    if (std::abs(d) >= f.radius + kRoomPerRadius * radius) return d < 0 ? a : b;
    double value = a.value;
    blend(f, b.value, value);
    if (a.function == f.a && b.function == f.b) return {function, value};
    return {stand_in(function, a.function, b.function), value};
  }

  /// Number of smooth functions in it, and its smallest radius.
  std::size_t parts(std::uint32_t function, double& radius) const {
    const Function& f = all_[function];
    if (f.node) return 1;
    radius = std::min(radius, f.radius);
    return parts(f.a, radius) + parts(f.b, radius);
  }

  /// Creates regions for all pieces of many parts.
  void divide() {
    region_of_.assign(pieces_, kNowhere);
    const Box3 box = bounds();
    const Vec3 size = box.size();
    const double edge = std::max({size.x, size.y, size.z});
    if (box.empty() || !std::isfinite(edge)) return;
    for (const Node& n : nodes_) {
      double radius = std::numeric_limits<double>::infinity();
      if (n.kind != NodeKind::piece || region_of_[n.a] != kNowhere || parts(n.a, radius) < kManyBlended) continue;
      region_of_[n.a] = static_cast<std::uint32_t>(regions_.size());
      Region root;
      root.center = box.center(), root.edge = edge, root.function = n.a;
      regions_.push_back(root);
      divide_region(region_of_[n.a]);
    }
    stand_ins_.clear();
  }

  /// Divides only where the function may vanish, because others are hardly queried.
  void divide_region(std::uint32_t first) {
    std::vector<std::pair<std::uint32_t, int>> open{{first, 0}};  // the largest come first
    for (std::size_t next = 0; next < open.size(); ++next) {
      check_cancelled();
      const auto [r, level] = open[next];
      const Region region = regions_[r];
      double radius = std::numeric_limits<double>::infinity();
      if (level == kMostHalvings || regions_.size() > kMostRegions || all_.size() > kMostFunctions ||
          parts(region.function, radius) <= kFewBlended || region.edge < kLeastRegion * radius)
        continue;
      const auto child = static_cast<std::uint32_t>(regions_.size());
      regions_[r].child = child;
      for (unsigned k = 0; k < 8; ++k) {
        Region part;
        part.edge = region.edge / 2;
        part.center =
            region.center + Vec3{k & 1u ? 1.0 : -1.0, k & 2u ? 1.0 : -1.0, k & 4u ? 1.0 : -1.0} * (part.edge / 2);
        const Local here = within(region.function, part.center, kBallOfRegion * part.edge);
        part.function = here.function;
        regions_.push_back(part);
        if (std::abs(here.value) <= kBallOfRegion * part.edge) open.emplace_back(child + k, level + 1);
      }
    }
  }

  /// Simplification of the piece within `radius` of x.
  std::uint32_t near(std::uint32_t piece, const Vec3& x, double radius) const {
    if (region_of_[piece] == kNowhere) return piece;
    const Region* region = &regions_[region_of_[piece]];
    const Vec3 off = x - region->center;
    if (!(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) <= region->edge / 2)) return piece;
    while (region->child != kNowhere) {
      const Vec3& c = region->center;
      const Region* part =
          &regions_[region->child + (x.x > c.x ? 1u : 0u) + (x.y > c.y ? 2u : 0u) + (x.z > c.z ? 4u : 0u)];
      if (radius > 0 && norm(x - part->center) + radius > kBallOfRegion * part->edge) break;
      region = part;
    }
    return region->function;
  }

  /// The piece that a function simplifies.
  std::uint32_t origin(std::uint32_t function) const {
    return function < pieces_ ? function : origin_[function - pieces_];
  }

  /// Replaces the first value by the blend of both; returns the weight of the second.
  static double blend(const Function& f, double b, double& a) {
    const double d = a - b;
    if (std::abs(d) < f.radius) {
      a = (a + b) / 2 - f.sign * (f.radius * f.radius + d * d) / (4 * f.radius);
      return 0.5 + f.sign * d / (2 * f.radius);
    }
    if (f.sign * d <= 0) return 0;
    a = b;
    return 1;
  }

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
      const double weight = blend(f, other[i], values[i]);
      if (!gradients || weight == 0) continue;
      gradients[i] = weight == 1 ? slope[i] : (1 - weight) * gradients[i] + weight * slope[i];
    }
  }

  /// Result of a blend within `radius` of x: the first function (−1), the second (1) or neither (0).
  int side_of(std::uint32_t blend, const Vec3& x, double radius) const {
    const Function& f = all_[blend];
    double a = 0, b = 0;
    ask(f.a, &x, 1, &a, nullptr);
    ask(f.b, &x, 1, &b, nullptr);
    const double d = f.sign * (a - b), room = kRoomPerRadius * radius;
    return std::abs(d) < f.radius + room ? 0 : d < 0 ? -1 : 1;
  }

  /// curvature_bound of a function, where its value is between two values.
  double curvature_bound_of(std::uint32_t function, const Vec3& x, double radius, double least, double most) const {
    const Function& f = all_[function];
    if (f.node) {
      const double factor = f.frame.sign * f.frame.map.scale;
      const double level = ((factor > 0 ? least : most) - f.frame.shift) / factor;
      return f.node->curvature_bound(f.piece, f.frame.map.back(x), radius / f.frame.map.scale, level) /
             f.frame.map.scale;
    }
    const int side = side_of(function, x, radius);
    if (side != 0) return curvature_bound_of(side < 0 ? f.a : f.b, x, radius, least, most);
    double a = 0, b = 0;
    Vec3 ga, gb;
    ask(f.a, &x, 1, &a, &ga);
    ask(f.b, &x, 1, &b, &gb);
    // Both values differ from the blend by at most its radius, on the side of its sign.
    const double low = least - (f.sign < 0 ? f.radius : 0), high = most + (f.sign > 0 ? f.radius : 0);
    const double of_a = curvature_bound_of(f.a, x, radius, std::max(low, a - radius), std::min(high, a + radius));
    const double of_b = curvature_bound_of(f.b, x, radius, std::max(low, b - radius), std::min(high, b + radius));
    const double apart = std::min(2.0, norm(ga - gb) + (of_a + of_b) * radius);
    return std::max(of_a, of_b) + apart * apart / (2 * f.radius);
  }

  std::shared_ptr<const SolidNode> root_;
  std::vector<Function> all_;             ///< pieces, then their simplifications in regions
  std::vector<std::uint32_t> origin_;     ///< piece of each simplification
  std::vector<std::uint32_t> region_of_;  ///< first region of each piece
  std::vector<Region> regions_;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> stand_ins_;  ///< keyed by piece and both functions
  std::uint32_t pieces_ = 0;
};

}  // namespace

ExpressionBuilder::ExpressionBuilder(double tie, const Box3& box) : tie_(tie) {
  if (box.empty() || !is_finite(box.lower) || !is_finite(box.upper)) return;
  middle_ = box.center(), radius_ = box.diagonal() / 2;
}

std::optional<ExpressionBuilder::Plane> ExpressionBuilder::plane_of(const Function& function) const {
  const ExpressionFrame& frame = function.frame;
  const double level = -frame.shift / (frame.sign * frame.map.scale);
  if (function.node->curvature_bound(function.piece, frame.map.back(middle_), radius_ / frame.map.scale, level) > 0)
    return std::nullopt;
  Plane plane;
  evaluate_function(function, &middle_, 1, &plane.value, &plane.gradient);
  return plane;
}

bool ExpressionBuilder::full() const { return functions.size() > kMostFunctions || nodes.size() > kMostNodes; }

void ExpressionBuilder::merge_equal_parts() {
  if (most_shells_ < kManyShells || nodes.size() <= kManyNodes * functions.size()) return;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> known;
  std::vector<std::uint32_t> number(nodes.size());
  std::uint32_t kept = 0;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    Node n = nodes[k];
    if (n.kind != NodeKind::piece) {
      n.a = number[n.a], n.b = number[n.b];
      if (n.a == n.b) {
        number[k] = n.a;
        continue;
      }
    }
    const auto [at, is_new] = known.try_emplace({static_cast<std::uint32_t>(n.kind), n.a, n.b}, kept);
    number[k] = at->second;
    if (is_new) nodes[kept++] = n;
  }
  nodes.resize(number.back() + 1);  // the root is last
}

std::uint32_t ExpressionBuilder::add(const Node& node) {
  nodes.push_back(node);
  return static_cast<std::uint32_t>(nodes.size() - 1);
}

std::uint32_t ExpressionBuilder::piece(const SolidNode& node, std::uint32_t number, const ExpressionFrame& frame) {
  check_cancelled();
  Function function;
  function.node = &node, function.piece = number, function.frame = frame;
  function.frame.shift += frame.tie;
  // If many solids have a face in the same plane, as many pieces would meet all over it.
  if (std::optional<Plane> plane = radius_ > 0 ? plane_of(function) : std::nullopt) {
    const double key = plane->value + radius_ * dot(plane->gradient, kAnywhere), near = kSamePlane * tie_;
    for (auto p = planes_.lower_bound(key - near); p != planes_.end() && p->first <= key + near; ++p)
      if (std::abs(p->second.value - plane->value) + radius_ * norm(p->second.gradient - plane->gradient) <= near)
        return add({NodeKind::piece, p->second.function, 0});
    plane->function = static_cast<std::uint32_t>(functions.size());
    planes_.emplace(key, *plane);
  }
  functions.push_back(function);
  // Otherwise equal pieces of two solids never coincide.
  const double share = static_cast<double>(functions.size() * 0x9e3779b1u % 1024u) / 1024;
  functions.back().frame.shift += kTieOfFunction * (frame.tie == 0 ? tie_ : std::abs(frame.tie)) * share;
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
  // Separates coincident surfaces: parts of a union overlap, those of an intersection leave a gap. The same holds, to a
  // smaller degree, for the parts of an inner node.
  ExpressionFrame inner = frame;
  if (frame.tie == 0) {
    inner.tie = -side * tie_;
  } else if (frame.tie * side > 0) {
    inner.tie = -side * std::max(kTieOfPart * std::abs(frame.tie), kLeastTie * tie_);
  }
  return inner;
}

std::optional<std::uint32_t> ExpressionBuilder::combine(const std::vector<NodePtr>& members, double sign,
                                                        const ExpressionFrame& frame) {
  const double side = sign * frame.sign;
  const ExpressionFrame inner = frame_of_parts(frame, side);
  std::vector<std::uint32_t> roots;
  for (const NodePtr& m : members) {
    const std::optional<std::uint32_t> root = m->express(*this, inner);
    if (!root || full()) return std::nullopt;
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
  if (!second || full()) return std::nullopt;
  if (radius == 0) return combine(kind, *first, *second);

  // A blend is monotonic in both values: the blend of minima and maxima is minima and maxima of blends, one for each
  // pair of functions.
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
    check_cancelled();
    return copied(of_b, middle, [&](std::uint32_t g) {
      Function blend;
      blend.a = f, blend.b = g, blend.radius = radius * frame.map.scale, blend.sign = side;
      // Equal functions are merged: f or g may have been merged before.
      std::vector<std::uint32_t>& known = blends_[{f, g}];
      for (const std::uint32_t k : known)
        if (functions[k].radius == blend.radius && functions[k].sign == side) return add({NodeKind::piece, k, 0});
      known.push_back(static_cast<std::uint32_t>(functions.size()));
      functions.push_back(blend);
      return add({NodeKind::piece, known.back(), 0});
    });
  });
}

std::shared_ptr<const PieceExpression> expression_of(std::shared_ptr<const SolidNode> root, double tie) {
  ExpressionBuilder builder(tie, box_of(*root));
  if (!root->express(builder, {})) return nullptr;
  builder.merge_equal_parts();
  return std::make_shared<SolidExpression>(std::move(root), std::move(builder));
}

std::shared_ptr<const PieceExpression> Solid::expression(double tie) const { return expression_of(node_, tie); }

}  // namespace sansmesh::inline v1
