// Height grid of a mesh.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Heights of the highest triangles over the centres of square cells (edge in lengths, > 0), whose borders are
/// multiples of the edge; unknown beside the mesh. Throws DataError if there are too many cells.
HeightGrid make_mesh_heights(const TriangleMesh& mesh, double cell, Progress& progress);

}  // namespace sansmesh::inline v1
