#include "sansmesh/csg/solid.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/csg/solid_node.h"

namespace sansmesh {
namespace {

/// Points that go through the whole tree together: the buffers of all nodes on the way stay in the cache.
constexpr std::size_t kBatch = 512;
/// Evaluation and destruction go as deep as the tree.
constexpr int kMaxDepth = 1000;
constexpr std::uint64_t kMaxPieces = 1u << 30;

template <class T>
std::span<T> part(std::span<T> all, std::size_t first, std::size_t last) {
  return all.empty() ? all : all.subspan(first, last - first);
}

/// body(first, last) on batches.
template <class Body>
void in_batches(std::size_t n, Body&& body) {
  const std::size_t batches = (n + kBatch - 1) / kBatch;
  parallel_for(0, batches, 1, [&](std::size_t b) { body(b * kBatch, std::min(n, (b + 1) * kBatch)); });
}

}  // namespace

SolidNode::SolidNode(const Traits& traits)
    : pieces_(static_cast<std::uint32_t>(traits.pieces)),
      rise_(traits.rise),
      lipschitz_(traits.lipschitz),
      cost_(traits.cost),
      depth_(traits.depth),
      thickness_(traits.thickness),
      hollow_thickness_(traits.hollow_thickness) {
  if (traits.depth > kMaxDepth)
    throw ArgumentError(fmt::format("solids are nested more than {} deep: combine them in groups", kMaxDepth));
  if (traits.pieces > kMaxPieces) throw ArgumentError("the solid has too many pieces: combine fewer solids");
}

SolidNode::Traits SolidNode::above(const SolidNode& child) {
  return {.pieces = child.pieces(),
          .rise = child.rise(),
          .lipschitz = child.lipschitz(),
          .cost = child.cost(),
          .depth = child.depth() + 1,
          .thickness = child.thickness(),
          .hollow_thickness = child.hollow_thickness()};
}

void SolidNode::keep_extents() {
  for (std::size_t k = 0; k < 6; ++k) {
    Vec3 n;
    n[k / 2] = k % 2 ? 1 : -1;
    extents_[k] = support(n);
    hollow_extents_[k] = hollow_support(n);
  }
}

void SolidNode::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  std::vector<double> values(x.size());
  evaluate(x, values, {}, {});
  for (std::size_t i = 0; i < x.size(); ++i) found[i] = {values[i] - radius, values[i] + radius};
}

double SolidNode::far_value(double sign, const Vec3& x, double radius) const {
  const Extents& e = sign > 0 ? extents_ : hollow_extents_;
  double outside = 0;
  for (std::size_t k = 0; k < 3; ++k) outside = std::max({outside, -x[k] - e[2 * k], x[k] - e[2 * k + 1]});
  return outside > radius ? rise_ * (outside - radius) : -kUnbounded;
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
  return normalized(value / largest);  // squares of huge or tiny components would overflow
}

Box3 Solid::bounds() const {
  const Extents& e = node_->extents();
  return {{-e[0], -e[2], -e[4]}, {e[1], e[3], e[5]}};
}

void Solid::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  in_batches(x.size(), [&](std::size_t first, std::size_t last) {
    node_->evaluate(part(x, first, last), part(values, first, last), part(gradients, first, last), {});
  });
}

std::uint32_t Solid::pieces() const { return node_->pieces(); }

void Solid::active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const {
  in_batches(x.size(), [&](std::size_t first, std::size_t last) {
    std::vector<double> values(last - first);
    node_->evaluate(part(x, first, last), values, {}, part(piece, first, last));
  });
}

void Solid::evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                           std::span<Vec3> gradients) const {
  in_batches(x.size(), [&](std::size_t first, std::size_t last) {
    node_->evaluate_piece(piece, part(x, first, last), part(values, first, last), part(gradients, first, last));
  });
}

std::optional<double> Solid::slope_bound() const {
  return node_->lipschitz() ? std::optional<double>(1) : std::nullopt;
}

double Solid::thickness() const {
  const double thinnest = thinner(node_->thickness(), node_->hollow_thickness());
  return thinnest > 0 ? thinnest : kUnbounded;
}

void Solid::survey(std::span<const Vec3> x, const SurveyReach& reach, std::span<double> values,
                   std::span<Surroundings> around) const {
  in_batches(x.size(), [&](std::size_t first, std::size_t last) {
    std::vector<ValueRange> ranges(last - first);
    node_->survey(part(x, first, last), reach, part(values, first, last), part(around, first, last), ranges);
  });
}

void Solid::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  in_batches(x.size(), [&](std::size_t first, std::size_t last) {
    node_->ranges(part(x, first, last), radius, part(found, first, last));
  });
}

}  // namespace sansmesh
