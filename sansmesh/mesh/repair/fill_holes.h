// Finds and fills the holes of a mesh.
#pragma once

#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/repair_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Finds all boundary loops; coincident vertices count as one. Loops that touch at a vertex are separate.
HoleLoops find_holes(const TriangleMesh& mesh);

/// Triangulates each hole with the least maximal angle between triangles, and then the least area [liepa2003]. Adds
/// vertices where the bi-Laplacian vanishes: the filling continues the tangent planes of its surroundings. Colours,
/// normals and attributes of new vertices are distance-weighted means of border vertices; those of new triangles are
/// unknown. Independent of the number of threads.
FillReport fill_holes(TriangleMesh& mesh, const FillOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
