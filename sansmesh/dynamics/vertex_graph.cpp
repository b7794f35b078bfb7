#include "sansmesh/dynamics/vertex_graph.h"

#include <algorithm>
#include <utility>

#include "sansmesh/core/edge_key.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/dynamics/tet_geometry.h"

namespace sansmesh::inline v1 {

VertexGraph vertex_graph(std::span<const Tet> tets, std::size_t vertices) {
  std::vector<std::uint64_t> keys(6 * tets.size());
  parallel_for(0, tets.size(), 4096, [&](std::size_t k) {
    for (std::size_t e = 0; e < 6; ++e) keys[6 * k + e] = edge_key(tets[k][kTetEdges[e][0]], tets[k][kTetEdges[e][1]]);
  });
  parallel_sort(keys);
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());

  VertexGraph graph;
  graph.edges.reserve(keys.size());
  for (const std::uint64_t key : keys) graph.edges.push_back({smaller_end(key), larger_end(key)});
  // Edges ascend by their smaller end. Visiting first the half-edges to smaller vertices, then the others, keeps rows
  // ascending.
  Adjacency32 half_edges = group_rows<std::uint32_t>(vertices, [&](const auto& visit) {
    for (std::size_t e = 0; e < keys.size(); ++e) visit(graph.edges[e][1], e);
    for (std::size_t e = 0; e < keys.size(); ++e) visit(graph.edges[e][0], e);
  });
  graph.begin = std::move(half_edges.first), graph.edge_of = std::move(half_edges.entries);
  graph.neighbours.resize(graph.edge_of.size());
  parallel_for(0, vertices, 4096, [&](std::size_t v) {
    for (std::size_t h = graph.begin[v]; h < graph.begin[v + 1]; ++h) {
      const auto [a, b] = graph.edges[graph.edge_of[h]];
      graph.neighbours[h] = a == v ? b : a;
    }
  });
  return graph;
}

Adjacency32 corners_of_vertices(std::span<const Tet> tets, std::size_t vertices) {
  return group_rows<std::uint32_t>(vertices, [&](const auto& visit) {
    for (std::size_t c = 0; c < 4 * tets.size(); ++c) visit(tets[c / 4][c % 4], c);
  });
}

Adjacency32 tets_of_edges(std::span<const Tet> tets, const VertexGraph& graph) {
  const auto edge_between = [&](std::uint32_t a, std::uint32_t b) {
    const auto first = graph.neighbours.begin() + graph.begin[a], last = graph.neighbours.begin() + graph.begin[a + 1];
    return graph.edge_of[static_cast<std::size_t>(std::lower_bound(first, last, b) - graph.neighbours.begin())];
  };
  std::vector<std::uint32_t> edges(6 * tets.size());
  parallel_for(0, tets.size(), 4096, [&](std::size_t k) {
    for (std::size_t e = 0; e < 6; ++e) {
      edges[6 * k + e] = edge_between(tets[k][kTetEdges[e][0]], tets[k][kTetEdges[e][1]]);
    }
  });
  return group_rows<std::uint32_t>(graph.edges.size(), [&](const auto& visit) {
    for (std::size_t k = 0; k < edges.size(); ++k) {
      const Tet& t = tets[k / 6];
      std::size_t a = kTetEdges[k % 6][0], b = kTetEdges[k % 6][1];
      if (t[a] > t[b]) std::swap(a, b);
      visit(edges[k], 16 * (k / 6) + 4 * a + b);
    }
  });
}

}  // namespace sansmesh::inline v1
