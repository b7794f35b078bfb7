// Minima and maxima of smooth functions → mesh, with walls of any thickness.
#pragma once

#include <cstddef>
#include <limits>

#include "sansmesh/field/piece_expression.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct PieceSurfaceOptions {
  /// Mean distance between curved parts and their triangles (length, > 0).
  double mesh_error = 0;
  /// Edge of the blocks along curved parts (length); 0: what the error asks for.
  double cell = 0;
  /// Collapse edges while the quadric error stays below this (length); 0: nowhere.
  double simplify = 0;
  /// Where pieces are flat, below this too (length): however long a bar is, its error is that of its thickness.
  double flat_error = std::numeric_limits<double>::infinity();
  /// At most this many triangles, if simplification can; 0: any number.
  std::size_t triangles = 0;
  std::size_t most_blocks = 0;  ///< more are not made
};

struct PieceSurfaceReport {
  double cell = 0;  ///< edge of the smallest block
  int depth = 0;
  std::size_t blocks = 0;                    ///< leaves of the tree
  double unresolved = 0;                     ///< as in PieceBlocks
  bool unsimplified = false;                 ///< simplified, it would have gone through itself
  bool too_many = false;                     ///< it would have taken more than `most_blocks`: nothing was made
  double mean_error = 0, largest_error = 0;  ///< distance of triangles' middles from the surface (length)
  double rounded_away = 0;                   ///< by how much floats change the volume, as a share of it
};

/// The zero set in the box as a closed manifold whose creases are edges: docs/methods/polygonisation.md. Vertices on
/// creases and corners are on their pieces, others on the surface or straddling it. Deterministic for any number of
/// threads. Empty if there is no surface. Throws DataError where more pieces meet in a place than can be told apart.
TriangleMesh polygonize_pieces(const PieceExpression& field, const Box3& box, const Vec3& origin,
                               const PieceSurfaceOptions& options, Progress& progress, PieceSurfaceReport& report);

}  // namespace sansmesh::inline v1
