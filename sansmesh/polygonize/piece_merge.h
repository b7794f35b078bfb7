// Fewer and better triangles for what was cut out of simplices.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/polygonize/piece_cut.h"

namespace sansmesh::inline v1 {

struct PieceMergeOptions {
  /// Vertices are merged into neighbours as near as this share of the edge of the blocks there...
  double near = 0;
  /// ... and into any where no triangle leaves its plane by more than this (length).
  double flat = 0;
  /// Edges shorter than this are points (length).
  double nothing = 0;
  /// Which vertices are on flat pieces only: around those, triangles leave their planes by no more than this (length).
  std::vector<std::uint8_t> straight;
  double rounding = 0;
};

/// Merges vertices into neighbours that are on the same pieces at least: corners stay, creases remain creases.
/// `normal`: where each triangle's piece points there; triangles that are folded against it count as bad ones, to be
/// got rid of. No vertex goes where a triangle would leave its plane by more than a quarter of the room that is known.
/// Drops the vertices that are not used any more, and keeps the topology. Returns what each vertex has become.
std::vector<std::uint32_t> merge_pieces(CutPieces& mesh, std::vector<Vec3>& normal, const PieceMergeOptions& options);

}  // namespace sansmesh::inline v1
