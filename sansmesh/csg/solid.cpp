#include "sansmesh/csg/solid.h"

#include <algorithm>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/csg/solid_node.h"

namespace sansmesh {
namespace {

/// Points that go through the whole tree together: the buffers of all nodes on the way stay in the cache.
constexpr std::size_t kBatch = 512;

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
