// Principal curvatures at the vertices of a mesh.
#pragma once

#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/surface/curvature.h"

namespace sansmesh::inline v1 {

/// Noise of the vertices (length) if known. An estimate from few vertices would mistake the shape of a mesh for noise.
double known_noise(const PointSet& mesh);

/// Like estimate_curvatures, but neighbours are the vertices along the edges, ring by ring: they are on all sides of a
/// vertex for any grading of the triangles, and on its own sheet. The number of rings is at least two, and large enough
/// to hold most of `neighbours` (default: as there, from the known noise), or with `radius` all within 1.6 h.
/// Without options of either, the data choose between quadrics, quartics and, on coarse meshes, directional curvatures
/// of one ring (curvature_choice.h). Coincident vertices count as one. If so few neighbours do not determine all
/// unknowns, the fitted surface passes through the vertex, and then keeps its normal. Undefined at vertices of no
/// triangle. Throws ArgumentError for invalid options, DataError for a mesh without normals or triangles.
std::vector<FittedCurvatures> estimate_vertex_curvatures(const PointSet& mesh, const CurvatureOptions& options,
                                                         Progress& progress);

}  // namespace sansmesh::inline v1
