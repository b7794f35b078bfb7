#include "sansmesh/volume/grid/coincident_points.h"

#include <cmath>

#include "sansmesh/box.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/volume/cells/box_tree.h"

namespace sansmesh::inline v1 {

std::vector<std::uint32_t> coincident_points(std::span<const Vec3> points, std::span<const double> shortest_edges,
                                             std::span<const std::uint8_t> joinable) {
  const std::size_t n = points.size();
  Box3 whole;
  std::vector<std::uint32_t> some;
  for (std::size_t p = 0; p < n; ++p) {
    if (!std::isfinite(shortest_edges[p])) continue;  // no cell's corner
    whole.extend(points[p]);
    if (joinable[p]) some.push_back(static_cast<std::uint32_t>(p));
  }
  const double most = 1e-6 * whole.diagonal();
  const auto tolerance = [&](std::uint32_t p) { return std::min(0.01 * shortest_edges[p], most); };
  const BoxTree tree(some.size(), [&](std::size_t i) {
    const double t = tolerance(some[i]);
    return Box3{points[some[i]] - Vec3{t, t, t}, points[some[i]] + Vec3{t, t, t}};
  });
  constexpr std::size_t kChunk = 4096;
  std::vector<std::vector<std::uint64_t>> pairs((some.size() + kChunk - 1) / kChunk);
  parallel_for(0, pairs.size(), 1, [&](std::size_t chunk) {
    std::vector<std::uint32_t> near;
    for (std::size_t i = chunk * kChunk; i < std::min(some.size(), (chunk + 1) * kChunk); ++i) {
      const std::uint32_t p = some[i];
      tree.containing(points[p], near);
      for (const std::uint32_t k : near) {
        const std::uint32_t q = some[k];
        if (q <= p) continue;
        const double t = std::min(tolerance(p), tolerance(q));
        if (squared_norm(points[p] - points[q]) <= t * t)
          pairs[chunk].push_back(static_cast<std::uint64_t>(p) << 32 | q);
      }
    }
  });
  UnionFind sets(n);
  bool any = false;
  for (const auto& chunk : pairs)
    for (const std::uint64_t pair : chunk)
      any = sets.join(static_cast<std::uint32_t>(pair >> 32), static_cast<std::uint32_t>(pair)) || any;
  if (!any) return {};
  std::vector<std::uint32_t> first(n);
  for (std::size_t p = 0; p < n; ++p) first[p] = sets.find(static_cast<std::uint32_t>(p));
  return first;
}

}  // namespace sansmesh::inline v1
