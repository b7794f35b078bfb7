// Moves the vertices of an extracted mesh onto the surface and its creases, and evens out their spacing.
#pragma once

#include <vector>

#include "sansmesh/mesh/vertex_corners.h"
#include "sansmesh/polygonize/polygonize_options.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Moves the vertices next to a crease onto it: where the normals around a vertex differ by more than 30°, to the
/// intersection of the surrounding tangent planes, if that is close and the field confirms that it is on the surface.
void snap_to_creases(const ScalarField& field, const std::vector<Triangle>& triangles, const VertexCorners& corners,
                     const std::vector<Vec3f>& normals, std::vector<Vec3>& x);

/// A mesh with its vertices on a curved surface is on one side of it. Moves each vertex along its normal by the mean
/// distance of the surrounding triangles, so that they straddle the surface: on a sphere the mean gap falls to a third.
/// Vertices at creases stay.
void balance_gaps(const ScalarField& field, const std::vector<Triangle>& triangles, const VertexCorners& corners,
                  const std::vector<Vec3f>& normals, std::vector<Vec3>& x);

/// Moves each vertex towards the area-weighted mean of its triangles' centroids, within its tangent plane: evens out
/// the spacing without changing the shape (to first order).
void smooth_tangentially(const std::vector<Triangle>& triangles, const VertexCorners& corners,
                         const std::vector<Vec3f>& normals, int rounds, std::vector<Vec3>& x);

/// After simplification: moves vertices back onto the surface, or makes triangles straddle it, where it is smooth. At
/// creases they keep the positions that the quadrics give, and everywhere with `keep`. Computes the normals.
void place_again(const ScalarField& field, const PolygonizeOptions& options, bool keep, TriangleMesh& mesh,
                 std::vector<Vec3>& x);

}  // namespace sansmesh::inline v1
