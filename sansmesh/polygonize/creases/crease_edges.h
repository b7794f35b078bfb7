// Aligns edges of a mesh with the creases of the field that it was extracted from.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Flips edges that bridge a crease between two vertices on it: the edge is replaced by the other diagonal of its two
/// triangles if that diagonal's midpoint is closer to the zero set of the field. `x` and
/// `normals`: the vertices' positions, which stay, and unit normals of the field there. No edge may have more than two
/// triangles. Returns the number of flipped edges.
std::size_t turn_edges_to_creases(const ScalarField& field, std::span<const Vec3> x, std::span<const Vec3f> normals,
                                  std::vector<Triangle>& triangles);

}  // namespace sansmesh::inline v1
