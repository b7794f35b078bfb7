// Fewer triangles where a mesh with creases is exactly flat.
#pragma once

#include "sansmesh/polygonize/piece_mesh.h"

namespace sansmesh::inline v1 {

/// Merges vertices into neighbours where no triangle around leaves its plane by more than `error` (length): within flat
/// parts, and along straight creases between them. Vertices that stay keep their places and ranks, triangles their
/// pieces, creases their edges. Far quicker than simplification by quadrics, for which it leaves the rest. The mesh
/// must be an oriented manifold. Triangles become no worse than the shape (4√3 A / Σ l²) 0.3, or than they were.
void thin_flat_parts(PieceMesh& mesh, double error);

}  // namespace sansmesh::inline v1
