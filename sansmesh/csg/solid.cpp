#include "sansmesh/csg/solid.h"

#include <algorithm>
#include <array>
#include <vector>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/csg/solid_node.h"

namespace sansmesh::inline v1 {
namespace {

/// Number of points evaluated together through the whole tree, so that the buffers of all nodes stay in the cache.
constexpr std::size_t kBatch = 512;

template <class T>
std::span<T> part(std::span<T> all, std::size_t first, std::size_t last) {
  return all.empty() ? all : all.subspan(first, last - first);
}

/// Trees with a larger cost per point have many parts, of which few are relevant at one point: batches of neighbours
/// evaluate fewer of them. One external field costs 50.
constexpr double kManyParts = 120;
/// Number of points sorted together.
constexpr std::size_t kSlab = std::size_t{1} << 18;

/// Indices of these points along a Morton curve.
std::vector<std::uint64_t> morton_order(std::span<const Vec3> x) {
  constexpr std::uint32_t kCells = 1023;
  const Box3 box = finite_bounds(x);
  Vec3 scale;
  for (std::size_t k = 0; k < 3; ++k) scale[k] = box.size()[k] > 0 ? kCells / box.size()[k] : 0;
  std::vector<std::uint64_t> order(x.size());
  parallel_for(0, x.size(), 4096, [&](std::size_t i) {
    std::array<std::uint32_t, 3> cell{};
    for (std::size_t k = 0; k < 3 && is_finite(x[i]); ++k)
      cell[k] = index_in<std::uint32_t>((x[i][k] - box.lower[k]) * scale[k], 0, kCells);
    order[i] = morton_code(cell[0], cell[1], cell[2]) << 32 | i;
  });
  parallel_sort(order);
  for (std::uint64_t& o : order) o &= 0xffffffffU;
  return order;
}

/// Calls ask(x, values, gradients) with the points, in the given order or, for many points of a tree with many parts,
/// slab by slab as neighbours; results are returned in the given order. `First` and `Second` may be any result types.
template <class First, class Second, class Ask>
void ask_neighbours(const SolidNode& node, std::span<const Vec3> x, std::span<First> first, std::span<Second> second,
                    Ask&& ask) {
  if (x.size() <= kBatch || node.cost() < kManyParts) return ask(x, first, second);
  for (std::size_t begin = 0; begin < x.size(); begin += kSlab) {
    const std::size_t n = std::min(kSlab, x.size() - begin);
    const std::vector<std::uint64_t> order = morton_order(x.subspan(begin, n));
    std::vector<Vec3> at(n);
    std::vector<First> one(first.empty() ? 0 : n);
    std::vector<Second> other(second.empty() ? 0 : n);
    for (std::size_t i = 0; i < n; ++i) at[i] = x[begin + order[i]];
    ask(std::span<const Vec3>(at), std::span(one), std::span(other));
    for (std::size_t i = 0; i < one.size(); ++i) first[begin + order[i]] = one[i];
    for (std::size_t i = 0; i < other.size(); ++i) second[begin + order[i]] = other[i];
  }
}

/// Calls body(first, last) on batches.
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
  ask_neighbours(*node_, x, values, gradients, [&](auto at, auto value, auto gradient) {
    in_batches(at.size(), [&](std::size_t first, std::size_t last) {
      node_->evaluate(part(at, first, last), part(value, first, last), part(gradient, first, last), {});
    });
  });
}

std::uint32_t Solid::pieces() const { return node_->pieces(); }

void Solid::active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const {
  ask_neighbours(*node_, x, piece, std::span<double>(), [&](auto at, auto active, auto) {
    in_batches(at.size(), [&](std::size_t first, std::size_t last) {
      std::vector<double> values(last - first);
      node_->evaluate(part(at, first, last), values, {}, part(active, first, last));
    });
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
  ask_neighbours(*node_, x, values, around, [&](auto at, auto value, auto surroundings) {
    in_batches(at.size(), [&](std::size_t first, std::size_t last) {
      std::vector<ValueRange> ranges(last - first);
      node_->survey(part(at, first, last), reach, part(value, first, last), part(surroundings, first, last), ranges);
    });
  });
}

void Solid::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  in_batches(x.size(), [&](std::size_t first, std::size_t last) {
    node_->ranges(part(x, first, last), radius, part(found, first, last));
  });
}

}  // namespace sansmesh::inline v1
