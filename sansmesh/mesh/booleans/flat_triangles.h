// Removal of triangles without area.
#pragma once

#include <vector>

#include "sansmesh/data/boolean_expression.h"

namespace sansmesh::inline v1 {

/// The triangles of a solid without those whose corners are collinear: edges of length zero are contracted, other flat
/// triangles are merged into the neighbour at their longest edge. The points of the surface stay the same.
std::vector<Triangle> without_flat_triangles(const SolidFaces& solid);

}  // namespace sansmesh::inline v1
