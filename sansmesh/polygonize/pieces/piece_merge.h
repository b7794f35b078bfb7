// Reduces and improves the triangles that piece_cut.h extracts.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/polygonize/pieces/piece_cut.h"

namespace sansmesh::inline v1 {

struct PieceMergeOptions {
  /// Vertices collapse into neighbours closer than this fraction of the local block edge...
  double near = 0;
  /// ... and into any neighbour if no triangle leaves its plane by more than this (length).
  double flat = 0;
  /// Edges shorter than this are collapsed (length).
  double nothing = 0;
  /// Marks vertices on flat pieces only: triangles around them leave their planes by at most `rounding` (length).
  std::vector<std::uint8_t> straight;
  double rounding = 0;
};

/// Collapses vertices into neighbours that are on at least the same pieces: corners stay, creases remain creases.
/// `normal` is the direction of each triangle's piece; triangles folded against it count as badly shaped. No collapse
/// makes a triangle leave its plane by more than a quarter of the known room. Drops unused vertices and preserves the
/// topology. Returns the new index of each vertex.
std::vector<std::uint32_t> merge_pieces(CutPieces& mesh, std::vector<Vec3>& normal, const PieceMergeOptions& options);

}  // namespace sansmesh::inline v1
