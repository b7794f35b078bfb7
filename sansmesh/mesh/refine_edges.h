// Long edges cut in half.
#pragma once

#include <cstddef>

#include "sansmesh/data/triangle_mesh.h"

namespace sansmesh {

/// Cuts edges longer than `length` in half, again and again, together with the triangles at them, without opening
/// seams: so that a map reaches the middle of large triangles. Attributes of vertices are interpolated, those of
/// triangles go to their parts. Stops before there are more than `most_triangles`; returns whether all edges became
/// short enough. Throws ArgumentError unless length > 0.
bool refine_edges(TriangleMesh& mesh, double length, std::size_t most_triangles = 20000000);

}  // namespace sansmesh
