// Zero set of minima and maxima of functions that are linear in each simplex of a lattice.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/polygonize/pieces/piece_blocks.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Triangles with their pieces, and vertices with the pieces that vanish there.
struct CutPieces {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  struct Vertex {
    Vec3 x;
    std::array<std::uint32_t, 3> piece{kNone, kNone, kNone};  ///< vanishing pieces in ascending order
    float size = 0;                                           ///< edge of the smallest surrounding block
    /// Distance to the nearest other sheet, across the vertex's lattice edge or to sheets back to back or face to face
    /// with its own; infinity: unknown.
    float room = std::numeric_limits<float>::infinity();
    std::uint32_t rank() const { return piece[1] == kNone ? 1 : piece[2] == kNone ? 2 : 3; }
  };
  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> piece;  ///< piece of each triangle
  /// A point with more than kMostPiecesInBlock pieces in its block; nothing was cut then.
  std::optional<Vec3> crowded;
  /// A point where two simplices disagree on the sides of a polygon in their common face: the mesh is not closed there
  /// and possibly elsewhere. Other lattice points help.
  std::optional<Vec3> cracked;
};

/// Each piece is linear in each simplex, so planes divide the simplex. The surface is the boundary between inside and
/// outside of that subdivision: closed for any pieces and any thickness of walls. All decisions use integers, of values
/// rounded to 2⁻⁴⁰ of the root block. Neighbours therefore agree: the subdivision of a shared face or edge depends only
/// on the values at its corners. Vertices are on the linear pieces, not yet on the pieces themselves. Throws DataError
/// where values change faster than distances do, or are not finite.
CutPieces cut_pieces(const PieceExpression& field, const PieceBlocks& blocks, Progress& progress);

}  // namespace sansmesh::inline v1
