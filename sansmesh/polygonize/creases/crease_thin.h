// Removes triangles from exactly flat parts of a mesh with creases.
#pragma once

#include "sansmesh/polygonize/pieces/piece_mesh.h"

namespace sansmesh::inline v1 {

/// Collapses vertices into neighbours where no surrounding triangle leaves its plane by more than `error` (length):
/// within flat parts and along straight creases between them. Remaining vertices keep their positions and ranks,
/// triangles their pieces, creases their edges. Much faster than the quadric simplification that follows. The mesh must
/// be an oriented manifold. No triangle's shape (4√3 A / Σ l²) falls below 0.3, or below its former shape.
void thin_flat_parts(PieceMesh& mesh, double error);

}  // namespace sansmesh::inline v1
