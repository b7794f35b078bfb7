#include "sansmesh/dynamics/vertex_graph.h"

#include <algorithm>

#include "sansmesh/core/edge_key.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/dynamics/tet_geometry.h"

namespace sansmesh::inline v1 {
namespace {

/// Prefix sums of counts: count[i] is at begin[i + 1].
void sum_up(std::vector<std::uint32_t>& begin) {
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
}

}  // namespace

VertexGraph vertex_graph(std::span<const Tet> tets, std::size_t vertices) {
  std::vector<std::uint64_t> keys(6 * tets.size());
  parallel_for(0, tets.size(), 4096, [&](std::size_t k) {
    for (std::size_t e = 0; e < 6; ++e) keys[6 * k + e] = edge_key(tets[k][kTetEdges[e][0]], tets[k][kTetEdges[e][1]]);
  });
  parallel_sort(keys);
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());

  VertexGraph graph;
  graph.begin.assign(vertices + 1, 0);
  for (const std::uint64_t key : keys) {
    const std::uint32_t a = smaller_end(key), b = larger_end(key);
    graph.edges.push_back({a, b});
    ++graph.begin[a + 1], ++graph.begin[b + 1];
  }
  sum_up(graph.begin);
  graph.neighbours.resize(2 * keys.size()), graph.edge_of.resize(2 * keys.size());
  std::vector<std::uint32_t> next(graph.begin.begin(), graph.begin.end() - 1);
  const auto add = [&](std::uint32_t from, std::uint32_t to, std::size_t edge) {
    const std::uint32_t at = next[from]++;
    graph.neighbours[at] = to, graph.edge_of[at] = static_cast<std::uint32_t>(edge);
  };
  // Edges ascend by their smaller end. Adding first the half-edges to smaller vertices, then the others, keeps rows
  // ascending.
  for (std::size_t e = 0; e < keys.size(); ++e) add(graph.edges[e][1], graph.edges[e][0], e);
  for (std::size_t e = 0; e < keys.size(); ++e) add(graph.edges[e][0], graph.edges[e][1], e);
  return graph;
}

ItemLists corners_of_vertices(std::span<const Tet> tets, std::size_t vertices) {
  ItemLists lists;
  lists.begin.assign(vertices + 1, 0);
  for (const Tet& t : tets) {
    for (const std::uint32_t v : t) ++lists.begin[v + 1];
  }
  sum_up(lists.begin);
  lists.items.resize(4 * tets.size());
  std::vector<std::uint32_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for (std::size_t c = 0; c < lists.items.size(); ++c) {
    lists.items[next[tets[c / 4][c % 4]]++] = static_cast<std::uint32_t>(c);
  }
  return lists;
}

ItemLists tets_of_edges(std::span<const Tet> tets, const VertexGraph& graph) {
  const auto edge_between = [&](std::uint32_t a, std::uint32_t b) {
    const auto first = graph.neighbours.begin() + graph.begin[a], last = graph.neighbours.begin() + graph.begin[a + 1];
    return graph.edge_of[static_cast<std::size_t>(std::lower_bound(first, last, b) - graph.neighbours.begin())];
  };
  std::vector<std::uint32_t> edges(6 * tets.size());
  ItemLists lists;
  lists.begin.assign(graph.edges.size() + 1, 0);
  parallel_for(0, tets.size(), 4096, [&](std::size_t k) {
    for (std::size_t e = 0; e < 6; ++e) {
      edges[6 * k + e] = edge_between(tets[k][kTetEdges[e][0]], tets[k][kTetEdges[e][1]]);
    }
  });
  for (const std::uint32_t e : edges) ++lists.begin[e + 1];
  sum_up(lists.begin);
  lists.items.resize(edges.size());
  std::vector<std::uint32_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const Tet& t = tets[k / 6];
    std::size_t a = kTetEdges[k % 6][0], b = kTetEdges[k % 6][1];
    if (t[a] > t[b]) std::swap(a, b);
    lists.items[next[edges[k]]++] = static_cast<std::uint32_t>(16 * (k / 6) + 4 * a + b);
  }
  return lists;
}

}  // namespace sansmesh::inline v1
