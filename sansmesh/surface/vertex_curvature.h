// Principal curvatures at the vertices of a mesh.
#pragma once

#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/surface/curvature.h"

namespace sansmesh::inline v1 {

/// Noise of the vertices (length) where it is known: few vertices leave the shape of a mesh as noise, which it is not.
double known_noise(const PointSet& mesh);

/// As estimate_curvatures, but neighbours are the vertices along the edges, ring by ring: they lie on all sides of a
/// vertex, however the triangles are graded, and on its own sheet. There are two rings at least, and as many as hold
/// most of `neighbours` (default: as there, for the noise that is known), or with `radius` as lie within 1.6 h.
/// Vertices at the same place are one. Where so few neighbours do not tell all that is to be fitted, the fitted surface
/// passes through the vertex, and then keeps its normal. Not defined at vertices of no triangle. Throws ArgumentError
/// for bad options, DataError for a mesh without normals or triangles.
std::vector<PrincipalCurvatures> estimate_vertex_curvatures(const PointSet& mesh, const CurvatureOptions& options,
                                                            Progress& progress);

}  // namespace sansmesh::inline v1
