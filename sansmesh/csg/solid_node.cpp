#include "sansmesh/csg/solid_node.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

/// Limit of the tree's depth, because evaluation and destruction are recursive.
constexpr int kMaxNesting = 1000;
constexpr std::uint64_t kMaxPieces = 1u << 30;
/// Relative rounding error of values, for a path of a thousand nodes.
constexpr double kValueRounding = 2e-12;

}  // namespace

SolidNode::SolidNode(const Traits& traits)
    : pieces_(static_cast<std::uint32_t>(traits.pieces)),
      rise_(traits.rise),
      lipschitz_(traits.lipschitz),
      cost_(traits.cost),
      depth_(traits.depth),
      thickness_(traits.thickness),
      hollow_thickness_(traits.hollow_thickness),
      magnitude_(traits.magnitude) {
  if (traits.depth > kMaxNesting)
    throw ArgumentError(fmt::format("solids are nested more than {} deep: combine them in groups", kMaxNesting));
  if (traits.pieces > kMaxPieces) throw ArgumentError("the solid has too many pieces: combine fewer solids");
}

SolidNode::Traits SolidNode::above(const SolidNode& child) {
  return {.pieces = child.pieces(),
          .rise = child.rise(),
          .lipschitz = child.lipschitz(),
          .cost = child.cost(),
          .depth = child.depth() + 1,
          .thickness = child.thickness(),
          .hollow_thickness = child.hollow_thickness(),
          .magnitude = child.magnitude()};
}

void SolidNode::Traits::join(const SolidNode& child) {
  pieces += child.pieces();
  rise = std::min(rise, child.rise());
  lipschitz = lipschitz && child.lipschitz();
  cost += child.cost();
  depth = std::max(depth, 1 + child.depth());
  magnitude = std::max(magnitude, child.magnitude());
  thickness = thinner(thickness, child.thickness());
  hollow_thickness = thinner(hollow_thickness, child.hollow_thickness());
}

void SolidNode::keep_extents() {
  for (std::size_t k = 0; k < 6; ++k) {
    Vec3 n;
    n[k / 2] = k % 2 ? 1 : -1;
    extents_[k] = support(n);
    hollow_extents_[k] = hollow_support(n);
    for (const double e : {std::abs(extents_[k]), std::abs(hollow_extents_[k])})
      if (std::isfinite(e)) magnitude_ = std::max(magnitude_, e);
  }
}

void SolidNode::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  std::vector<double> values(x.size());
  evaluate(x, values, {}, {});
  for (std::size_t i = 0; i < x.size(); ++i) found[i] = {values[i] - radius, values[i] + radius};
}

std::optional<std::uint32_t> SolidNode::express(ExpressionBuilder&, const ExpressionFrame&) const {
  return std::nullopt;
}

std::optional<std::uint32_t> SolidNode::faces(FaceBuilder&, const Similarity&) const { return std::nullopt; }

double SolidNode::curvature_bound(std::uint32_t, const Vec3&, double, double) const { return kUnbounded; }

double SolidNode::far_value(double sign, const Vec3& x, double radius) const {
  return least_value(outside_of(sign > 0 ? extents_ : hollow_extents_, x), rise_, radius);
}

double outside_of(const Extents& e, const Vec3& x) {
  double outside = -kUnbounded;
  for (std::size_t k = 0; k < 3; ++k) outside = std::max({outside, -x[k] - e[2 * k], x[k] - e[2 * k + 1]});
  return outside;
}

double least_value(double outside, double rise, double radius) {
  return outside > radius ? rise * (outside - radius) : -kUnbounded;
}

double value_rounding(const SolidNode& node, const Vec3& x, double radius) {
  return kValueRounding * (std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}) + radius + node.magnitude());
}

double thinner(double a, double b) { return (a > 0) == (b > 0) ? std::min(a, b) : std::max(a, b); }

void require_finite(const char* what, const char* name, double value) {
  if (!std::isfinite(value)) throw ArgumentError(fmt::format("{}: {} must be a finite number", what, name));
}

void require_finite(const char* what, const char* name, const Vec3& value) {
  if (!is_finite(value)) throw ArgumentError(fmt::format("{}: {} must have finite coordinates", what, name));
}

void require_positive(const char* what, const char* name, double value) {
  require_finite(what, name, value);
  if (!(value > 0)) throw ArgumentError(fmt::format("{}: {} must be positive, not {}", what, name, value));
}

Vec3 require_direction(const char* what, const char* name, const Vec3& value) {
  require_finite(what, name, value);
  const double largest = std::max({std::abs(value.x), std::abs(value.y), std::abs(value.z)});
  if (!(largest > 0)) throw ArgumentError(fmt::format("{}: {} must have a direction, not be (0, 0, 0)", what, name));
  return normalized(value / largest);  // squares of huge or tiny components would overflow or underflow
}

}  // namespace sansmesh::inline v1
