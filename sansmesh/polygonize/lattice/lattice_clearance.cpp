#include "sansmesh/polygonize/lattice/lattice_clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {

namespace {

/// Least distance of lattice vertices from the surface, as a fraction of the smallest block's edge; they move by up to
/// twice that.
constexpr double kStandBack = 0.08;

/// New position of a lattice vertex that is closer to a sheet than `least`, or between two sheets closer to each other
/// than that: moved along the normal until all of them are on one side.
Vec3 stand_back(const PieceExpression& field, std::span<const PieceNode> nodes, const Vec3& x, double least) {
  struct Sheet {
    double value;
    Vec3 gradient;
  };
  thread_local std::vector<Sheet> near;
  near.clear();
  for (const PieceNode& n : nodes) {
    if (n.kind != PieceNode::Kind::piece) continue;
    Sheet s{};
    field.evaluate_piece(n.a, {&x, 1}, {&s.value, 1}, {&s.gradient, 1});
    const double slope = norm(s.gradient);
    if (!(slope > 0.1) || std::abs(s.value) > 2 * least * slope) continue;
    near.push_back({s.value / slope, s.gradient / slope});
  }
  if (near.empty()) return x;
  const auto nearest = std::min_element(
      near.begin(), near.end(), [](const Sheet& a, const Sheet& b) { return std::abs(a.value) < std::abs(b.value); });
  if (std::abs(nearest->value) >= least) return x;
  const Vec3 normal = nearest->gradient;
  double lowest = 0, highest = 0;
  bool first = true;
  for (const Sheet& s : near) {
    const double along = dot(s.gradient, normal);
    if (std::abs(along) < 0.9) continue;
    const double height = along > 0 ? s.value : -s.value;
    lowest = first ? height : std::min(lowest, height);
    highest = first ? height : std::max(highest, height);
    first = false;
  }
  const double up = least - lowest, down = least + highest;
  const double by = up < down ? up : -down;
  return std::abs(by) <= 2 * least ? x + normal * by : x;
}

}  // namespace

std::vector<Vec3> clear_lattice(const PieceExpression& field, const PieceBlocks& blocks,
                                const std::vector<std::uint32_t>& numbers, const std::vector<std::size_t>& first,
                                const std::vector<LatticePoint>& points) {
  constexpr std::uint32_t kUnowned = ~std::uint32_t{0};
  const BlockTree& tree = blocks.tree;
  std::vector<std::uint32_t> owner(points.size(), kUnowned);
  std::vector<float> edge(points.size(), std::numeric_limits<float>::max());
  for (std::uint32_t i = 0; i < blocks.leaves.size(); ++i) {
    const auto e = static_cast<float>(tree.block_edge(blocks.leaves[i].block));
    for (std::size_t s = first[i]; s < first[i + 1]; ++s) {
      if (owner[numbers[s]] == kUnowned) owner[numbers[s]] = i;
      edge[numbers[s]] = std::min(edge[numbers[s]], e);
    }
  }
  std::vector<Vec3> positions(points.size());
  parallel_for(0, points.size(), 1024, [&](std::size_t v) {
    const PieceBlocks::Leaf& leaf = blocks.leaves[owner[v]];
    positions[v] = stand_back(field, std::span(blocks.nodes).subspan(leaf.first, leaf.count),
                              lattice_position(tree, points[v]), kStandBack * static_cast<double>(edge[v]));
  });
  return positions;
}

}  // namespace sansmesh::inline v1
