// Aligns edges of a mesh with the creases of the field that it was extracted from.
#pragma once

#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Flips edges that bridge a crease between two vertices on it: the edge is replaced by the other diagonal of its two
/// triangles if that diagonal's midpoint is closer to the zero set of the field. Positions are unchanged. Returns the
/// number of flipped edges.
std::size_t turn_edges_to_creases(TriangleMesh& mesh, const ScalarField& field);

}  // namespace sansmesh::inline v1
