// A mesh that stores for each triangle its piece of the field.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/polygonize/pieces/piece_meeting.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct PieceMesh {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  std::vector<Vec3> x;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> piece;  ///< piece of each triangle, or kNone: it crosses a crease that could not be placed
  std::vector<std::uint8_t> rank;    ///< per vertex: 0 not on the surface, 1 smooth, 2 crease, 3 corner
};

/// Removes unused vertices; the others keep their order.
void drop_unused_vertices(PieceMesh& mesh);

/// Moves the vertices off creases along their normals by so small an amount that the triangles straddle their pieces
/// (balance_gaps with one piece per triangle).
void balance_pieces(const PiecewiseField& field, PieceMesh& mesh);

/// Restores the pieces of a mesh whose creases are edges, after simplification: finds the piece of each triangle, and
/// moves each vertex back onto its pieces where no triangle deteriorates.
PieceMesh recall_pieces(const PiecewiseField& field, std::vector<Vec3> x, std::vector<Triangle> triangles);

/// Vertex normals: gradients of the adjacent pieces, weighted by the angles of their triangles.
std::vector<Vec3f> piece_normals(const PiecewiseField& field, const PieceMesh& mesh);

}  // namespace sansmesh::inline v1
