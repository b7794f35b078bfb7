// Analytic primitives: shapes with a few smooth pieces and one inlined loop over points.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/csg/face_builder.h"
#include "sansmesh/csg/solid.h"
#include "sansmesh/csg/solid_expression.h"
#include "sansmesh/csg/solid_node.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

struct Sample {
  double value = 0;
  Vec3 gradient;
};

constexpr double kNextToAxis = 1e-6;  ///< over the distance along the axis

/// Coordinates of a point relative to an axis: position along it, distance, and outward direction.
struct AroundAxis {
  double along, radius;
  Vec3 outward;  ///< unit; zero on the axis

  AroundAxis(const Vec3& d, const Vec3& axis) : along(dot(d, axis)) {
    Vec3 away = d - along * axis;
    radius = norm(away);
    // Next to the axis the remainder is mostly rounding, and partly along the axis.
    if (radius < kNextToAxis * std::abs(along)) {
      away = away - dot(away, axis) * axis;
      radius = norm(away);
    }
    if (radius > 0) outward = away / radius;
  }
};

/// Support of a disc.
double disc_support(const Vec3& n, const Vec3& center, const Vec3& axis, double radius) {
  const double c = dot(n, axis);
  return dot(n, center) + radius * std::sqrt(std::max(0.0, 1 - c * c));
}

/// Second derivative of a distance to a point or a curve at this distance.
double curvature_at(double distance) { return distance > 0 ? 1 / distance : kUnbounded; }
/// The same for a shape that narrows to a point, in a ball of radius `reach`. Blocks are never small enough close to
/// the point, which counts as resolved there.
double curvature_at_tip(double distance, double reach) {
  constexpr double kClose = 1.5;
  return distance > kClose * reach ? 1 / distance : kUnbounded;
}

template <class Shape>
class PrimitiveNode final : public SolidNode {
 public:
  explicit PrimitiveNode(const Shape& shape)
      : SolidNode(Traits{.pieces = shape.pieces(),
                         .rise = shape.rise(),
                         .thickness = shape.thickness(),
                         .hollow_thickness = shape.hollow_thickness(),
                         .magnitude = shape.magnitude()}),
        shape_(shape) {
    keep_extents();
  }

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                std::span<std::uint32_t> active) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      Sample s;
      const std::uint32_t piece = shape_.choose(x[i], s);
      values[i] = s.value;
      if (!gradients.empty()) gradients[i] = s.gradient;
      if (!active.empty()) active[i] = piece;
    }
  }

  void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                      std::span<Vec3> gradients) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Sample s = shape_.at(piece, x[i]);
      values[i] = s.value;
      if (!gradients.empty()) gradients[i] = s.gradient;
    }
  }

  void survey(std::span<const Vec3> x, const SurveyReach&, std::span<double> values, std::span<Surroundings> around,
              std::span<ValueRange>) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      Sample s;
      const std::uint32_t piece = shape_.choose(x[i], s);
      values[i] = s.value;
      around[i] = {shape_.alone(piece, x[i], s.value), kUnbounded};
    }
  }

  double least(double sign, const Vec3& x, double radius) const override {
    Sample s;
    shape_.choose(x, s);
    return sign * s.value - radius;
  }
  std::optional<std::uint32_t> express(ExpressionBuilder& builder, const ExpressionFrame& frame) const override {
    // The level of its values that becomes 0 in the whole: deep within rounded boxes nothing is round.
    const double level = -frame.shift / (frame.sign * frame.map.scale);
    return builder.pieces(*this, shape_.largest_of(level), frame);
  }
  std::optional<std::uint32_t> faces(FaceBuilder& builder, const Similarity& map) const override {
    return shape_.faces(builder, map);
  }
  double curvature_bound(std::uint32_t piece, const Vec3& x, double radius, double level) const override {
    return shape_.curvature_bound(piece, x, radius, level);
  }
  bool singly_curved() const override { return Shape::kSinglyCurved; }
  double support(const Vec3& n) const override { return shape_.support(n); }
  double hollow_support(const Vec3& n) const override { return shape_.hollow_support(n); }

 private:
  Shape shape_;
};

template <class Shape>
Solid solid_of(const Shape& shape) {
  return Solid(std::make_shared<PrimitiveNode<Shape>>(shape));
}

/// Defaults of most shapes: one piece, bounded, an exact distance.
struct SmoothShape {
  static constexpr bool kSinglyCurved = false;  ///< straight in one direction everywhere
  std::uint32_t pieces() const { return 1; }
  /// Where the value is `level`, it is the largest of this many pieces; 0: a separate function.
  std::uint32_t largest_of(double) const { return 0; }
  double rise() const { return 1; }
  double hollow_support(const Vec3&) const { return kUnbounded; }
  double hollow_thickness() const { return kUnbounded; }
  /// See SolidNode::magnitude.
  double magnitude() const { return 0; }
  /// Radius around x, where the piece is active with this value, in which it is the only one.
  double alone(std::uint32_t, const Vec3&, double) const { return kUnbounded; }
};

struct Ball : SmoothShape {
  Vec3 center;
  double radius = 0;

  Sample at(std::uint32_t, const Vec3& x) const {
    const Vec3 d = x - center;
    const double r = norm(d);
    return {r - radius, r > 0 ? d / r : Vec3{}};
  }
  std::uint32_t choose(const Vec3& x, Sample& s) const { return s = at(0, x), 0; }
  double curvature_bound(std::uint32_t, const Vec3&, double, double level) const {
    return curvature_at(radius + level);
  }
  double support(const Vec3& n) const { return dot(n, center) + radius; }
  double thickness() const { return 2 * radius; }
  std::optional<std::uint32_t> faces(FaceBuilder& b, const Similarity& map) const {
    return b.ball(center, radius, map);
  }
};

struct HalfSpace : SmoothShape {
  Vec3 normal;
  double offset = 0;

  Sample at(std::uint32_t, const Vec3& x) const { return {dot(normal, x) - offset, normal}; }
  std::uint32_t choose(const Vec3& x, Sample& s) const { return s = at(0, x), 0; }
  double curvature_bound(std::uint32_t, const Vec3&, double, double) const { return 0; }
  // Directions result from rotations: they are equal up to rounding.
  double support(const Vec3& n) const { return dot(n, normal) > 1 - 1e-14 ? offset : kUnbounded; }
  double hollow_support(const Vec3& n) const { return dot(n, normal) < -1 + 1e-14 ? -offset : kUnbounded; }
  double thickness() const { return kUnbounded; }
  double magnitude() const { return std::abs(offset); }
  std::optional<std::uint32_t> faces(FaceBuilder& b, const Similarity& map) const {
    return b.half_space(normal, offset, map);
  }
};

/// Pieces 0 to 5: the faces −x, +x, −y, … With rounding, 6: the rounded part.
struct Block : SmoothShape {
  Vec3 center, half;  ///< half the size, minus the rounding
  Vec3 lower, upper;  ///< corners as given
  double rounding = 0;

  std::uint32_t pieces() const { return rounding > 0 ? 7 : 6; }
  std::uint32_t largest_of(double level) const { return rounding > 0 && level > -rounding ? 0 : 6; }
  double rise() const { return rounding > 0 ? 1 : std::sqrt(1.0 / 3); }
  Sample at(std::uint32_t piece, const Vec3& x) const {
    const Vec3 d = x - center;
    if (piece < 6) {
      const std::size_t k = piece / 2;
      const double sign = piece % 2 ? 1 : -1;
      Sample s{sign * d[k] - half[k] - rounding, {}};
      s.gradient[k] = sign;
      return s;
    }
    Vec3 q;
    for (std::size_t k = 0; k < 3; ++k) q[k] = std::copysign(std::max(0.0, std::abs(d[k]) - half[k]), d[k]);
    const double r = norm(q);
    return {r - rounding, r > 0 ? q / r : Vec3{}};
  }
  std::uint32_t choose(const Vec3& x, Sample& s) const {
    const Vec3 d = x - center;
    std::size_t best = 0;
    int outside = 0;
    double largest = -kUnbounded;
    for (std::size_t k = 0; k < 3; ++k) {
      const double q = std::abs(d[k]) - half[k];
      outside += q > 0;
      if (q > largest) best = k, largest = q;
    }
    const std::uint32_t piece =
        rounding > 0 && outside > 1 ? 6 : static_cast<std::uint32_t>(2 * best + (std::signbit(d[best]) ? 0 : 1));
    s = at(piece, x);
    return piece;
  }
  double alone(std::uint32_t piece, const Vec3& x, double) const {
    const Vec3 d = x - center;
    Vec3 q;
    for (std::size_t k = 0; k < 3; ++k) q[k] = std::abs(d[k]) - half[k];
    // The rounded part begins where a second coordinate is outside of the box.
    if (piece == 6) return q.x + q.y + q.z - std::max({q.x, q.y, q.z}) - std::min({q.x, q.y, q.z});
    const std::size_t k = piece / 2;
    const double other = std::max(q[(k + 1) % 3], q[(k + 2) % 3]);
    const double until = rounding > 0 ? std::min(0.0, q[k]) : q[k];
    return std::min(std::abs(d[k]), std::max(0.0, until - other) / std::sqrt(2.0));
  }
  double curvature_bound(std::uint32_t piece, const Vec3& x, double reach, double level) const {
    if (piece < 6) return 0;
    Sample s;
    const std::uint32_t here = choose(x, s);
    if (here < 6 && alone(here, x, s.value) > reach) return 0;
    return curvature_at(rounding + level);
  }
  double support(const Vec3& n) const {
    return dot(n, center) + std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z + rounding;
  }
  double thickness() const { return 2 * (std::min({half.x, half.y, half.z}) + rounding); }
  std::optional<std::uint32_t> faces(FaceBuilder& b, const Similarity& map) const {
    if (rounding > 0) return b.refuse("a rounded box");
    return b.box(lower, upper, map);
  }
};

struct Pipe : SmoothShape {
  static constexpr bool kSinglyCurved = true;
  Vec3 center, axis;
  double radius = 0;

  Sample at(std::uint32_t, const Vec3& x) const {
    const AroundAxis a(x - center, axis);
    return {a.radius - radius, a.outward};
  }
  std::uint32_t choose(const Vec3& x, Sample& s) const { return s = at(0, x), 0; }
  double curvature_bound(std::uint32_t, const Vec3&, double, double level) const {
    return curvature_at(radius + level);
  }
  double support(const Vec3& n) const { return std::abs(dot(n, axis)) < 1e-14 ? dot(n, center) + radius : kUnbounded; }
  double thickness() const { return 2 * radius; }
  double magnitude() const { return norm(center); }
  std::optional<std::uint32_t> faces(FaceBuilder& b, const Similarity& map) const {
    return b.cylinder(center, axis, radius, map);
  }
};

/// Pieces: the side, the bottom, the top.
struct Frustum : SmoothShape {
  static constexpr bool kSinglyCurved = true;
  Vec3 center, axis;
  double bottom = 0, top = 0, half_height = 0;
  double slope = 0, cosine = 1;  ///< slope of the side (radius per height), and cosine of its angle to the axis

  std::uint32_t pieces() const { return 3; }
  std::uint32_t largest_of(double) const { return 3; }
  double curvature_bound(std::uint32_t piece, const Vec3& x, double reach, double level) const {
    if (piece > 0) return 0;
    const double along = dot(x - center, axis), narrow = along - std::copysign(reach, slope);
    const double radius = (bottom + top) / 2 + slope * (slope == 0 ? 0 : narrow) + level / cosine;
    const bool pointed = std::min(bottom, top) + level * (1 / cosine - std::abs(slope)) <= 0;
    return cosine * (pointed ? curvature_at_tip(radius, reach) : curvature_at(radius));
  }
  /// In front of an edge both pieces are seen at half the angle between their normals.
  double rise() const {
    const double sine = std::abs(slope) * cosine;  // inclination of the side's normal towards the narrow end
    return std::sqrt((1 - sine) / 2);
  }
  Sample at(std::uint32_t piece, const Vec3& x) const {
    const Vec3 d = x - center;
    if (piece == 1) return {-dot(d, axis) - half_height, -axis};
    if (piece == 2) return {dot(d, axis) - half_height, axis};
    const AroundAxis a(d, axis);
    return {(a.radius - (bottom + top) / 2 - slope * a.along) * cosine, (a.outward - slope * axis) * cosine};
  }
  /// Same values as at(), from precomputed axis coordinates.
  std::array<double, 3> values(const AroundAxis& a) const {
    return {(a.radius - (bottom + top) / 2 - slope * a.along) * cosine, -a.along - half_height, a.along - half_height};
  }
  std::uint32_t choose(const Vec3& x, Sample& s) const {
    const AroundAxis a(x - center, axis);
    const std::array<double, 3> value = values(a);
    const std::uint32_t side_or_bottom = value[1] > value[0] ? 1 : 0;
    const std::uint32_t piece = value[2] > value[side_or_bottom] ? 2 : side_or_bottom;
    s = {value[piece], piece == 0 ? (a.outward - slope * axis) * cosine : piece == 1 ? -axis : axis};
    return piece;
  }
  double alone(std::uint32_t piece, const Vec3& x, double value) const {
    const std::array<double, 3> all = values(AroundAxis(x - center, axis));
    return (value - std::max(all[(piece + 1) % 3], all[(piece + 2) % 3])) / 2;
  }
  double support(const Vec3& n) const {
    return std::max(disc_support(n, center - half_height * axis, axis, bottom),
                    disc_support(n, center + half_height * axis, axis, top));
  }
  /// Thickness at half the height, because no cells resolve a tip.
  double thickness() const { return std::min(2 * half_height, bottom + top); }
  std::optional<std::uint32_t> faces(FaceBuilder& b, const Similarity& map) const {
    return b.frustum(center, axis, bottom, top, half_height, map);
  }
};

struct Ring : SmoothShape {
  Vec3 center, axis;
  double ring = 0, tube = 0;

  Sample at(std::uint32_t, const Vec3& x) const {
    const AroundAxis a(x - center, axis);
    const Vec3 d = (a.radius - ring) * a.outward + a.along * axis;
    const double r = std::hypot(a.radius - ring, a.along);
    return {r - tube, r > 0 ? d / r : Vec3{}};
  }
  std::uint32_t choose(const Vec3& x, Sample& s) const { return s = at(0, x), 0; }
  double curvature_bound(std::uint32_t, const Vec3& x, double reach, double level) const {
    const double least = ring - tube - level, beside = AroundAxis(x - center, axis).radius - reach;
    // If the hole has closed, there are two dimples.
    return std::max(curvature_at(tube + level),
                    least > 0 ? curvature_at(std::max(least, beside)) : curvature_at_tip(beside, reach));
  }
  double support(const Vec3& n) const { return disc_support(n, center, axis, ring) + tube; }
  double thickness() const { return 2 * tube; }
  double hollow_thickness() const { return 2 * (ring - tube); }
  std::optional<std::uint32_t> faces(FaceBuilder& b, const Similarity& map) const {
    return b.ring(center, axis, ring, tube, map);
  }
};

struct Rod : SmoothShape {
  Vec3 from, along;  ///< not a unit vector
  double radius = 0;

  Sample at(std::uint32_t, const Vec3& x) const {
    const Vec3 d = x - from;
    const double t = std::clamp(dot(d, along) / squared_norm(along), 0.0, 1.0);
    const Vec3 away = d - t * along;
    const double r = norm(away);
    return {r - radius, r > 0 ? away / r : Vec3{}};
  }
  std::uint32_t choose(const Vec3& x, Sample& s) const { return s = at(0, x), 0; }
  double curvature_bound(std::uint32_t, const Vec3&, double, double level) const {
    return curvature_at(radius + level);
  }
  double support(const Vec3& n) const { return dot(n, from) + std::max(0.0, dot(n, along)) + radius; }
  double thickness() const { return 2 * radius; }
  std::optional<std::uint32_t> faces(FaceBuilder& b, const Similarity& map) const {
    return b.rod(from, from + along, radius, map);
  }
};

}  // namespace

namespace csg {

Solid sphere(const Vec3& center, double radius) {
  require_finite("sphere", "center", center);
  require_positive("sphere", "r", radius);
  Ball s;
  s.center = center, s.radius = radius;
  return solid_of(s);
}

Solid box(const Vec3& lower, const Vec3& upper, double rounding) {
  require_finite("box", "lower corner", lower);
  require_finite("box", "upper corner", upper);
  require_finite("box", "r", rounding);
  const Vec3 half = (upper - lower) * 0.5;
  const double least = std::min({half.x, half.y, half.z});
  if (!(least > 0))
    throw ArgumentError(fmt::format("box: size must be positive, not ({}, {}, {})", upper.x - lower.x,
                                    upper.y - lower.y, upper.z - lower.z));
  require_finite("box", "size", half);
  if (rounding < 0 || !(rounding < least))
    throw ArgumentError(
        fmt::format("box: r must lie between 0 and half the shortest edge, {}, not be {}", least, rounding));
  Block s;
  s.center = lower * 0.5 + upper * 0.5;
  s.half = half - Vec3{rounding, rounding, rounding};
  s.rounding = rounding;
  s.lower = lower, s.upper = upper;
  return solid_of(s);
}

Solid half_space(const Vec3& normal, double offset) {
  HalfSpace s;
  s.normal = require_direction("plane", "normal", normal);
  require_finite("plane", "offset", offset);
  s.offset = offset;
  return solid_of(s);
}

Solid cylinder(const Vec3& center, const Vec3& axis, double radius) {
  require_finite("cylinder", "center", center);
  require_positive("cylinder", "r", radius);
  Pipe s;
  s.center = center, s.axis = require_direction("cylinder", "axis", axis), s.radius = radius;
  return solid_of(s);
}

Solid cylinder(const Vec3& center, const Vec3& axis, double radius, double height) {
  require_finite("cylinder", "center", center);
  require_positive("cylinder", "r", radius);
  require_positive("cylinder", "h", height);
  Frustum s;
  s.center = center, s.axis = require_direction("cylinder", "axis", axis);
  s.bottom = s.top = radius, s.half_height = height / 2;
  return solid_of(s);
}

Solid cone(const Vec3& center, const Vec3& axis, double bottom, double top, double height) {
  require_finite("cone", "center", center);
  require_finite("cone", "r", bottom);
  require_finite("cone", "top", top);
  require_positive("cone", "h", height);
  if (bottom < 0 || top < 0 || bottom + top == 0)
    throw ArgumentError(
        fmt::format("cone: r and top must not be negative, nor both zero; they are {} and {}", bottom, top));
  Frustum s;
  s.center = center, s.axis = require_direction("cone", "axis", axis);
  s.bottom = bottom, s.top = top, s.half_height = height / 2;
  s.slope = (top - bottom) / height;
  s.cosine = 1 / std::hypot(1.0, s.slope);
  return solid_of(s);
}

Solid torus(const Vec3& center, const Vec3& axis, double ring, double tube) {
  require_finite("torus", "center", center);
  require_positive("torus", "R", ring);
  require_positive("torus", "r", tube);
  if (!(tube < ring))
    throw ArgumentError(
        fmt::format("torus: r must be less than R, or there is no hole; they are {} and {}", tube, ring));
  Ring s;
  s.center = center, s.axis = require_direction("torus", "axis", axis), s.ring = ring, s.tube = tube;
  return solid_of(s);
}

Solid capsule(const Vec3& from, const Vec3& to, double radius) {
  require_finite("capsule", "from", from);
  require_finite("capsule", "to", to);
  require_positive("capsule", "r", radius);
  require_direction("capsule", "to − from", to - from);
  Rod s;
  s.from = from, s.along = to - from, s.radius = radius;
  return solid_of(s);
}

}  // namespace csg
}  // namespace sansmesh::inline v1
