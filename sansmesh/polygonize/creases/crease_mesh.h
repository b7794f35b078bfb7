// Polygonization of fields with creases; creases become edges of the mesh.
#pragma once

#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/polygonize/polygonize.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

/// polygonize() for a field of smooth pieces: a closed 2-manifold with vertices on the curves where two pieces meet (on
/// both of them to the precision of the mesh) and at the points where three or more do, and with edges along these
/// curves, so that no triangle crosses a crease. Method: docs/methods/polygonisation.md.
///
/// Where a crease cannot be placed (pieces tangent within 2°, strips of surface narrower than a block), the mesh is
/// that of polygonize(), and still closed. Vertices off creases are on the surface, or straddle it with
/// `options.balance`. Vertex normals are the gradients of the vertex's piece; on creases they are the mean of the
/// pieces' normals, weighted by the angles of the triangles. `options.creases` and `options.placement` are ignored:
/// creases always come from `field` itself. `options.simplify` preserves creases and keeps their vertices on them.
/// Deterministic for any number of threads. Throws ArgumentError as polygonize() does.
TriangleMesh polygonize_with_creases(const PiecewiseField& field, BlockTree blocks, const Vec3& origin,
                                     const PolygonizeOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
