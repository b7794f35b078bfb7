// Field with creases → mesh with the creases as edges.
#pragma once

#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/polygonize/polygonize.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

/// polygonize() for a field of smooth pieces: the same closed 2-manifold, but with vertices on the curves where two
/// pieces meet (on both of them to the precision of the mesh) and in the points where three or more do, and with edges
/// along these curves, so that no triangle reaches across. The method is described in docs/methods/polygonisation.md.
///
/// Where a crease cannot be placed (pieces tangent to each other within 2°, strips of surface narrower than a block),
/// the mesh is that of polygonize(), and closed all the same. Vertices off creases are on the surface, or straddle it
/// with `options.balance`. Vertex normals are the gradients of the vertex's piece, on creases the mean of its pieces'
/// normals, weighted by the angles of their triangles. `options.creases` and `options.placement` are not used: creases
/// are always made, out of `field` itself. With `options.simplify` the creases stay creases, and their vertices on
/// them. Deterministic for any number of threads. Throws ArgumentError as polygonize() does.
TriangleMesh polygonize_with_creases(const PiecewiseField& field, BlockTree blocks, const Vec3& origin,
                                     const PolygonizeOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
