// Polygonization by the method of the sources (tejada2008, 4.4.3; polizelli, 3.3): the walk starts in a simplex at a
// sample and pivots across crossed faces. Each simplex gives one or two triangles; vertices are the zeros on lattice
// edges.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

struct WalkOptions {
  /// α, 0 ≤ α < 1. Before triangulation, a vertex v of a crossing simplex moves away from the surface, towards its own
  /// side along ∇F/‖∇F‖, by (M_l − |F(v)|)/M_l · α e(l)/4. l is the deepest level of the crossing simplices around it
  /// (on a refined face that of its parts), e(l) the edge of a block of that level, M_l the largest |F| among the
  /// vertices of that level.
  double displacement = 0;
  /// Walks start in the crossing simplices that contain these points. Sheets without a seed are not found.
  std::vector<Vec3> seeds;
};

struct WalkReport {
  std::size_t simplices = 0;  ///< crossing simplices visited by the walk
  std::size_t started = 0;    ///< seeds whose simplex crosses the surface
  std::size_t moved = 0;      ///< displaced lattice vertices
  /// Lattice vertices kept in place: the move would have changed their sign or inverted a simplex.
  std::size_t held = 0;
};

/// The zero set of `field` in the tree's cube as a closed 2-manifold: where it leaves the cube, it is closed just
/// inside the cube's faces. Vertex normals are the field's normalised gradients. Deterministic for any number of
/// threads. `blocks` is balanced first. Positions are relative to `origin`. Throws ArgumentError for a displacement out
/// of range.
TriangleMesh walk_surface(const ScalarField& field, BlockTree blocks, const Vec3& origin, const WalkOptions& options,
                          Progress& progress, WalkReport* report = nullptr);

}  // namespace sansmesh::inline v1
