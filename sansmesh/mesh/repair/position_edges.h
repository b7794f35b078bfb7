// Edges of a mesh whose vertices are identified by position.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Files often repeat a vertex where colours or normals jump, or for every triangle. Such seams are not borders:
/// coincident vertices count as one here, represented by the first of them.
struct PositionEdges {
  struct Edge {
    std::uint32_t a = 0, b = 0;          ///< representatives, a < b
    std::uint32_t first = 0, count = 0;  ///< corners[first .. first + count]
  };
  std::vector<std::uint32_t> representative;  ///< for each vertex, the first one at its position
  std::vector<Edge> edges;                    ///< ordered by a, then b
  /// Corners 3·triangle + k whose edge leads to the next corner of the triangle, grouped by edge, in ascending order.
  /// Skips triangles with a corner that is repeated, not finite or nonexistent.
  std::vector<std::uint32_t> corners;

  /// Whether a corner's edge runs from a to b.
  static bool forward(const TriangleMesh& mesh, const PositionEdges& all, const Edge& edge, std::uint32_t corner) {
    return all.representative[mesh.triangles[corner / 3][corner % 3]] == edge.a;
  }
};

/// Linear time and memory, apart from sorting. Throws DataError for more triangles than kMostTriangles.
PositionEdges edges_by_position(const TriangleMesh& mesh);

struct JoinedVertices {
  std::size_t joined = 0;  ///< removed vertices
  std::size_t seams = 0;   ///< vertices kept beside a coincident one: colours or attributes differ
};

/// Merges coincident vertices with equal colours and attributes; averages their normals. Keeps the number and order of
/// triangles.
JoinedVertices join_equal_vertices(TriangleMesh& mesh);

}  // namespace sansmesh::inline v1
