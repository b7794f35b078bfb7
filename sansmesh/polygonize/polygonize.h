// Polygonization of scalar fields: marching tetrahedra on the J₁ᴬ triangulation of a balanced block tree (castelo2006),
// with crossing points clustered at lattice vertices so that triangles are few and well shaped.
#pragma once

#include "sansmesh/polygonize/polygonize_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

/// The zero set of `field` in the tree's cube as a 2-manifold, closed unless a domain is given: where it leaves the
/// cube, it is closed just inside the cube's faces. Vertex normals are the field's normalised gradients. Deterministic
/// for any number of threads. `blocks` is balanced first. Positions are relative to `origin`.
TriangleMesh polygonize(const ScalarField& field, BlockTree blocks, const Vec3& origin,
                        const PolygonizeOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
