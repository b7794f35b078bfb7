// Holes of a mesh, found and filled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/repair_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// All loops; vertices at the same place are one. Where loops touch at a vertex, each is a loop of its own.
HoleLoops find_holes(const TriangleMesh& mesh);

/// Triangulates each hole so that the largest angle between triangles, and then the area, is least [liepa2003], adds
/// vertices, and places these where the Laplacian of the Laplacian vanishes: the filling has the tangents of its
/// surroundings. Colours, normals and attributes of new vertices are means of those of the border, by distance; of new
/// triangles they are unknown. The same for any number of threads.
FillReport fill_holes(TriangleMesh& mesh, const FillOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
