// Field → mesh as the sources have it: from a simplex at a sample the surface is walked by pivoting across the faces
// that it crosses, one triangle or two a simplex, with vertices where the values on the lattice's edges are zero
// (tejada2008, section 4.4.3; polizelli, section 3.3; METHODS §3.2, §3.3).
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/progress.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

struct WalkOptions {
  /// α, 0 ≤ α < 1: before the triangles are made, a vertex v of a crossing simplex moves away from the surface by
  /// (M_l − |F(v)|)/M_l · α e(l)/4, along ∇F/‖∇F‖ towards its own side. l is the deepest level of the crossing
  /// simplices around it (of a refined face that of its parts), e(l) the edge of a block of that level, M_l the largest
  /// |F| among the vertices of that level.
  double displacement = 0;
  /// Where walks start: in the simplices that hold these, where they cross. Sheets that none leads to are not found.
  std::vector<Vec3> seeds;
};

struct WalkReport {
  std::size_t simplices = 0;  ///< crossing ones, met by the walk
  std::size_t started = 0;    ///< seeds whose simplex crosses
  std::size_t moved = 0;      ///< lattice vertices that were displaced
  std::size_t held = 0;       ///< that stayed: the move would have changed their sign, or turned a simplex over
};

/// The zero set of `field` in the tree's cube as a closed 2-manifold: where it leaves the cube, it is closed just
/// inside of the cube's faces. Vertex normals are the field's normalised gradients. Deterministic for any number of
/// threads. `blocks` is balanced first. Positions are relative to `origin`. Throws ArgumentError for a displacement out
/// of range.
TriangleMesh walk_surface(const ScalarField& field, BlockTree blocks, const Vec3& origin, const WalkOptions& options,
                          Progress& progress, WalkReport* report = nullptr);

}  // namespace sansmesh::inline v1
