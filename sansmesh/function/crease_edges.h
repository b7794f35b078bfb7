// Edges of a mesh along the creases of the field that it was cut out of.
#pragma once

#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Where an edge of a mesh reaches across a crease, between two vertices on it, the other diagonal of its two triangles
/// takes its place: that whose middle is closer to the zero set of the field. Positions stay. How many edges turned.
std::size_t turn_edges_to_creases(TriangleMesh& mesh, const ScalarField& field);

}  // namespace sansmesh::inline v1
