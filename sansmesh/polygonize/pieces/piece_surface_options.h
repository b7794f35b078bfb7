// Options and report of polygonize_pieces().
#pragma once

#include <cstddef>
#include <limits>

namespace sansmesh::inline v1 {

struct PieceSurfaceOptions {
  /// Mean distance between curved parts and their triangles (length, > 0).
  double mesh_error = 0;
  /// Edge of the blocks along curved parts (length); 0: derived from the error.
  double cell = 0;
  /// Edges are collapsed while the quadric error stays below this (length); 0: off.
  double simplify = 0;
  /// Additional limit of the quadric error on flat pieces (length): the error of a long bar is that of its thickness.
  double flat_error = std::numeric_limits<double>::infinity();
  /// Target number of triangles; 0: none.
  std::size_t triangles = 0;
  std::size_t most_blocks = 0;  ///< largest number of blocks
};

struct PieceSurfaceReport {
  double cell = 0;  ///< edge of the smallest block
  int depth = 0;
  std::size_t blocks = 0;     ///< leaves of the tree
  double unresolved = 0;      ///< see PieceBlocks
  bool unsimplified = false;  ///< simplification was undone because the mesh would have intersected itself
  bool too_many = false;      ///< more than `most_blocks` are needed: no mesh
  double mean_error = 0, largest_error = 0;  ///< distance from triangle centroids to the surface (length)
  double rounded_away = 0;                   ///< relative change of the volume by rounding to float
};

}  // namespace sansmesh::inline v1
