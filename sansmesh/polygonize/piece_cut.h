// The zero set of minima and maxima of functions that are linear in each simplex of a lattice.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/polygonize/piece_blocks.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Triangles on pieces, and on which pieces their vertices lie.
struct CutPieces {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  struct Vertex {
    Vec3 x;
    std::array<std::uint32_t, 3> piece{kNone, kNone, kNone};  ///< in ascending order; those that vanish here
    float size = 0;                                           ///< edge of the smallest block around
    /// Distance from another sheet across the lattice edge that this vertex lies on, and from those that are back to
    /// back with its own or face to face; infinity: none known.
    float room = std::numeric_limits<float>::infinity();
    std::uint32_t rank() const { return piece[1] == kNone ? 1 : piece[2] == kNone ? 2 : 3; }
  };
  std::vector<Vertex> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> piece;  ///< of each triangle
  /// Where there are more than kMostPiecesInBlock pieces in one block: nothing was cut then.
  std::optional<Vec3> crowded;
  /// The sides of a polygon in a face between two simplices are not those seen from the other side: the mesh is not
  /// closed, here and perhaps elsewhere. Other lattice points help.
  std::optional<Vec3> cracked;
};

/// Between lattice vertices each piece is taken to be linear: a plane in each simplex, which these planes divide. What
/// parts the inside from the outside there is the surface: closed whatever the pieces are, however thin the walls. All
/// decisions are made in integers, on values rounded to 2⁻⁴⁰ of the root block; so neighbours agree, since what they
/// share depends on the values at its own corners only. Vertices are not on the pieces yet but where the linear ones
/// are. Throws DataError where values change faster than distances do, or are not finite.
CutPieces cut_pieces(const PieceExpression& field, const PieceBlocks& blocks, Progress& progress);

}  // namespace sansmesh::inline v1
