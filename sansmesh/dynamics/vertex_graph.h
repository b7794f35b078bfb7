// Edges of tetrahedra in compressed sparse rows, one row per vertex.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/data/group_rows.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// Half-edges begin[i] .. begin[i + 1] − 1 lead from vertex i to its neighbours, in ascending order.
struct VertexGraph {
  std::vector<std::uint32_t> begin;                 ///< one more than vertices
  std::vector<std::uint32_t> neighbours;            ///< target of each half-edge
  std::vector<std::uint32_t> edge_of;               ///< edge of each half-edge
  std::vector<std::array<std::uint32_t, 2>> edges;  ///< ends, the smaller first, ascending
};

VertexGraph vertex_graph(std::span<const Tet> tets, std::size_t vertices);

/// For each vertex its corners: 4 tetrahedron + corner, ascending.
Adjacency32 corners_of_vertices(std::span<const Tet> tets, std::size_t vertices);

/// For each edge of the graph the surrounding tetrahedra: 16 tetrahedron + 4 corner of its first end + corner of its
/// second, ascending.
Adjacency32 tets_of_edges(std::span<const Tet> tets, const VertexGraph& graph);

}  // namespace sansmesh::inline v1
