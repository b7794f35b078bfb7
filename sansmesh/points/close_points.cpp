#include "sansmesh/points/close_points.h"

#include <algorithm>
#include <numeric>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh {
namespace {

constexpr std::uint32_t kUnclaimed = ~std::uint32_t{0};
constexpr std::size_t kQueriesAtOnce = 1 << 14;

void check_distance(double distance) {
  if (!(distance >= 0 && distance < 1e18)) throw ArgumentError("a distance between points must lie in 0..1e18");
}

}  // namespace

std::vector<std::uint32_t> close_representatives(std::span<const Vec3f> positions, double distance) {
  check_distance(distance);
  const KdTree tree(positions);
  std::vector<std::uint32_t> of(positions.size(), kUnclaimed);
  std::vector<Neighbour> near;
  for (std::uint32_t i = 0; i < of.size(); ++i) {
    if (of[i] != kUnclaimed) continue;
    of[i] = i;
    tree.within(positions[i], static_cast<float>(distance), near);
    for (const Neighbour& n : near)
      if (of[n.index] == kUnclaimed) of[n.index] = i;
  }
  return of;
}

CloudComponents find_cloud_components(std::span<const Vec3f> positions, double distance, Progress& progress) {
  check_distance(distance);
  const KdTree tree(positions);
  const std::span<const std::uint32_t> order = tree.order();
  progress.begin("components", tree.size());
  UnionFind sets(positions.size());
  // Queries in parallel, joins one after the other. Points that follow each other in the tree lie close together: most
  // neighbours are in one part already and need not be told again.
  struct Edge {
    std::uint32_t a, b;
  };
  std::vector<std::vector<Edge>> edges;
  for (std::size_t first = 0; first < tree.size(); first += kQueriesAtOnce) {
    const std::size_t last = std::min(tree.size(), first + kQueriesAtOnce);
    constexpr std::size_t kShare = 1 << 10;
    edges.assign((last - first + kShare - 1) / kShare, {});
    parallel_for(0, edges.size(), 1, [&](std::size_t c) {
      std::vector<Neighbour> near;
      const std::size_t begin = first + c * kShare, end = std::min(last, begin + kShare);
      for (std::size_t slot = begin; slot < end; ++slot) {
        tree.within(tree.position(slot), static_cast<float>(distance), near);
        for (const Neighbour& n : near)
          if (n.index < order[slot]) edges[c].push_back({order[slot], n.index});
      }
    });
    for (const std::vector<Edge>& some : edges)
      for (const Edge& e : some) sets.join(e.a, e.b);
    progress.advance(last - first);
  }
  CloudComponents result;
  result.of_point.resize(positions.size());
  std::vector<std::uint32_t> number(positions.size(), kUnclaimed);
  for (std::uint32_t i = 0; i < number.size(); ++i) {
    std::uint32_t& c = number[sets.find(i)];
    if (c == kUnclaimed) {
      c = static_cast<std::uint32_t>(result.points.size());
      result.points.push_back(0);
    }
    result.of_point[i] = c;
    ++result.points[c];
  }
  std::vector<std::uint32_t> largest(result.size()), rank(result.size());
  std::iota(largest.begin(), largest.end(), 0u);
  std::stable_sort(largest.begin(), largest.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return result.points[a] > result.points[b]; });
  std::vector<std::size_t> points(result.size());
  for (std::uint32_t k = 0; k < rank.size(); ++k) rank[largest[k]] = k, points[k] = result.points[largest[k]];
  result.points = std::move(points);
  for (std::uint32_t& c : result.of_point) c = rank[c];
  return result;
}

}  // namespace sansmesh
