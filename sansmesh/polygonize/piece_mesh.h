// A mesh whose triangles know on which piece of the field they lie.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/polygonize/piece_meeting.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct PieceMesh {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  std::vector<Vec3> x;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t>
      piece;                       ///< of each triangle, or kNone: it reaches across a crease that could not be placed
  std::vector<std::uint8_t> rank;  ///< of each vertex: 0 not on the surface, 1 smooth, 2 crease, 3 corner
};

/// Removes the vertices that no triangle has; the others keep their order.
void drop_unused_vertices(PieceMesh& mesh);

/// Moves the vertices off creases by so little along their normals that the triangles straddle their pieces
/// (balance_gaps with one piece per triangle).
void balance_pieces(const PiecewiseField& field, PieceMesh& mesh);

/// For a mesh whose creases are edges but that forgot its pieces (after simplification): finds the piece of each
/// triangle, and puts each vertex on the pieces around it again where no triangle suffers.
PieceMesh recall_pieces(const PiecewiseField& field, std::vector<Vec3> x, std::vector<Triangle> triangles);

/// Vertex normals: the gradients of the pieces around, weighted by the angles of their triangles.
std::vector<Vec3f> piece_normals(const PiecewiseField& field, const PieceMesh& mesh);

}  // namespace sansmesh::inline v1
