// Polygonization of minima and maxima of smooth functions, with walls of any thickness.
#pragma once

#include "sansmesh/field/piece_expression.h"
#include "sansmesh/polygonize/pieces/piece_surface_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// The zero set in the box as a closed manifold whose creases are edges (docs/methods/polygonisation.md). Vertices on
/// creases and corners are on their pieces; others are on the surface or straddle it. Deterministic for any number of
/// threads. Empty if there is no surface. Throws DataError where more pieces meet than can be separated.
TriangleMesh polygonize_pieces(const PieceExpression& field, const Box3& box, const Vec3& origin,
                               const PieceSurfaceOptions& options, Progress& progress, PieceSurfaceReport& report);

}  // namespace sansmesh::inline v1
