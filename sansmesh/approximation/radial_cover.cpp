#include "sansmesh/approximation/radial_cover.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sansmesh/approximation/generating_functions.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kOverlap = 1.25;  ///< ratio of a ball's radius to that of its cell's circumsphere
constexpr int kMaxDepth = 90;
constexpr std::size_t kMaxFactor = 8;

}  // namespace

template <int D>
RadialCover<D>::RadialCover(const SampleIndex<D>& samples, std::size_t local_samples)
    : lower_(samples.lower()), upper_(samples.upper()), local_samples_(local_samples) {
  double extent = 0;
  for (std::size_t k = 0; k < D; ++k) extent = std::max(extent, upper_[k] - lower_[k]);
  const double margin = extent > 0 ? 0.1 * extent : 1;
  for (std::size_t k = 0; k < D; ++k) lower_[k] -= margin, upper_[k] += margin;

  // Cells are ranges of `order`, depth first; nodes_ is in the order of the cells.
  struct Cell {
    Position<D> lower, upper;
    std::size_t first, last;
    std::size_t node;
    int depth;
  };
  std::vector<std::uint32_t> order(samples.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<Cell> stack{{lower_, upper_, 0, order.size(), 0, 0}};
  nodes_.emplace_back();
  const std::size_t most = std::max<std::size_t>(local_samples / 3, 4);
  std::vector<typename SampleIndex<D>::Hit> hits;
  while (!stack.empty()) {
    const Cell cell = stack.back();
    stack.pop_back();
    Ball ball;
    double r2 = 0;
    std::size_t longest = 0;
    for (std::size_t k = 0; k < D; ++k) {
      const double edge = cell.upper[k] - cell.lower[k];
      ball.center[k] = cell.lower[k] + edge / 2;
      r2 += edge * edge / 4;
      if (edge > cell.upper[longest] - cell.lower[longest]) longest = k;
    }
    ball.radius = kOverlap * std::sqrt(r2);
    bool split = cell.last - cell.first > most;
    if (!split) {
      samples.within(ball.center, ball.radius, hits);
      split = hits.size() > kMaxFactor * local_samples;
    }
    if (!split || cell.depth >= kMaxDepth) {
      nodes_[cell.node].ball = static_cast<std::int32_t>(balls_.size());
      balls_.push_back(ball);
      continue;
    }
    const double middle = ball.center[longest];
    const auto begin = order.begin() + static_cast<std::ptrdiff_t>(cell.first);
    const auto end = order.begin() + static_cast<std::ptrdiff_t>(cell.last);
    const auto cut =
        std::partition(begin, end, [&](std::uint32_t i) { return samples.positions()[i][longest] < middle; });
    const auto at = static_cast<std::size_t>(cut - order.begin());
    Cell left = cell, right = cell;
    left.upper[longest] = right.lower[longest] = middle;
    left.last = right.first = at;
    left.depth = right.depth = cell.depth + 1;
    left.node = nodes_.size(), right.node = left.node + 1;
    nodes_[cell.node].left = static_cast<std::int32_t>(left.node);
    nodes_[cell.node].right = static_cast<std::int32_t>(right.node);
    nodes_.resize(nodes_.size() + 2);
    stack.push_back(left);
    stack.push_back(right);
  }
  // Reverse order visits children before their parents.
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    for (std::size_t k = 0; k < D; ++k) {
      if (node.ball >= 0) {
        const Ball& ball = balls_[static_cast<std::size_t>(node.ball)];
        node.lower[k] = ball.center[k] - ball.radius;
        node.upper[k] = ball.center[k] + ball.radius;
      } else {
        const Node &a = nodes_[static_cast<std::size_t>(node.left)], &b = nodes_[static_cast<std::size_t>(node.right)];
        node.lower[k] = std::min(a.lower[k], b.lower[k]);
        node.upper[k] = std::max(a.upper[k], b.upper[k]);
      }
    }
  }
}

template <int D>
void RadialCover<D>::members(std::size_t ball, const SampleIndex<D>& samples, std::vector<std::uint32_t>& out) const {
  thread_local std::vector<typename SampleIndex<D>::Hit> hits;
  const Ball& b = balls_[ball];
  samples.within(b.center, b.radius, hits);
  if (hits.size() < local_samples_) samples.nearest(b.center, local_samples_, hits);
  if (hits.size() > kMaxFactor * local_samples_) hits.resize(kMaxFactor * local_samples_);
  out.clear();
  for (const auto& hit : hits) out.push_back(hit.index);
  std::sort(out.begin(), out.end());
}

template <int D>
void RadialCover<D>::find(const Position<D>& x, std::vector<Part>& out) const {
  out.clear();
  Position<D> q;
  for (std::size_t k = 0; k < D; ++k) q[k] = std::clamp(x[k], lower_[k], upper_[k]);
  std::array<std::int32_t, kMaxDepth + 8> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(stack[--size])];
    bool inside = true;
    for (std::size_t k = 0; k < D; ++k) inside = inside && q[k] >= node.lower[k] && q[k] <= node.upper[k];
    if (!inside) continue;
    if (node.ball < 0) {
      stack[size++] = node.right;
      stack[size++] = node.left;
      continue;
    }
    const Ball& ball = balls_[static_cast<std::size_t>(node.ball)];
    const RadialValue w = weight(WeightFunction::kCompact, squared_distance<D>(q, ball.center), ball.radius);
    if (!(w.value > 0)) continue;
    Part part{static_cast<std::uint32_t>(node.ball), w.value, {}};
    for (std::size_t k = 0; k < D; ++k)
      if (q[k] == x[k]) part.slope[k] = w.slope * (q[k] - ball.center[k]);
    out.push_back(part);
  }
}

template class RadialCover<1>;
template class RadialCover<2>;
template class RadialCover<3>;

}  // namespace sansmesh::inline v1::detail
