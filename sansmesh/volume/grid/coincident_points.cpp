#include "sansmesh/volume/grid/coincident_points.h"

#include <cmath>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/parallel_collect.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/volume/cells/box_tree.h"

namespace sansmesh::inline v1 {

std::vector<std::uint32_t> joined_points(std::span<const Vec3> points, std::span<const std::uint32_t> joinable,
                                         const std::function<double(std::uint32_t)>& tolerance) {
  const BoxTree tree(joinable.size(), [&](std::size_t i) {
    const double t = tolerance(joinable[i]);
    return Box3{points[joinable[i]] - Vec3{t, t, t}, points[joinable[i]] + Vec3{t, t, t}};
  });
  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  const auto collect = [&](std::size_t first, std::size_t last, std::vector<Pair>& pairs) {
    std::vector<std::uint32_t> near;
    for (std::size_t i = first; i < last; ++i) {
      const std::uint32_t p = joinable[i];
      tree.containing(points[p], near);
      for (const std::uint32_t k : near) {
        const std::uint32_t q = joinable[k];
        if (q <= p) continue;
        const double t = std::min(tolerance(p), tolerance(q));
        if (squared_norm(points[p] - points[q]) <= t * t) pairs.emplace_back(p, q);
      }
    }
  };
  UnionFind sets(points.size());
  bool any = false;
  for (const auto& [p, q] : parallel_collect<Pair>(joinable.size(), 4096, collect)) any = sets.join(p, q) || any;
  if (!any) return {};
  std::vector<std::uint32_t> first(points.size());
  for (std::size_t p = 0; p < first.size(); ++p) first[p] = sets.find(static_cast<std::uint32_t>(p));
  return first;
}

std::vector<std::uint32_t> coincident_points(std::span<const Vec3> points, std::span<const double> shortest_edges,
                                             std::span<const std::uint8_t> joinable) {
  Box3 whole;
  std::vector<std::uint32_t> some;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (!std::isfinite(shortest_edges[p])) continue;  // not a cell corner
    whole.extend(points[p]);
    if (joinable[p]) some.push_back(static_cast<std::uint32_t>(p));
  }
  const double most = 1e-6 * whole.diagonal();
  return joined_points(points, some, [&](std::uint32_t p) { return std::min(0.01 * shortest_edges[p], most); });
}

}  // namespace sansmesh::inline v1
