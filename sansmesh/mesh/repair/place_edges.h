// The edges of a mesh, its vertices told apart by where they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Files often repeat a vertex where colours or normals jump, or for every triangle. Such seams are no borders: here
/// vertices at the same place are one, known by the first of them.
struct PlaceEdges {
  struct Edge {
    std::uint32_t a = 0, b = 0;          ///< places, a < b
    std::uint32_t first = 0, count = 0;  ///< corners[first .. first + count]
  };
  std::vector<std::uint32_t> place;  ///< of each vertex: the first one there
  std::vector<Edge> edges;           ///< ordered by a, then b
  /// Corners 3·triangle + k whose edge runs to the next corner of the triangle, edge after edge, each in ascending
  /// order. Triangles have none with a corner that is repeated, is not finite or does not exist.
  std::vector<std::uint32_t> corners;

  /// Whether a corner's edge runs from a to b.
  static bool forward(const TriangleMesh& mesh, const PlaceEdges& all, const Edge& edge, std::uint32_t corner) {
    return all.place[mesh.triangles[corner / 3][corner % 3]] == edge.a;
  }
};

/// Time and memory linear in the size of the mesh, but for sorting. Throws DataError for more triangles than can be
/// counted (kMostTriangles).
PlaceEdges edges_by_place(const TriangleMesh& mesh);

struct JoinedPlaces {
  std::size_t joined = 0;  ///< vertices that are gone
  std::size_t seams = 0;   ///< vertices that stay beside another one at their place: colours or attributes differ
};

/// Makes one vertex of those at the same place that have the same colours and attributes; their normals are averaged.
/// Triangles keep their number and order.
JoinedPlaces join_places(TriangleMesh& mesh);

/// Whether all corners of a triangle exist and are finite.
bool is_whole(const TriangleMesh& mesh, const Triangle& t);

}  // namespace sansmesh::inline v1
