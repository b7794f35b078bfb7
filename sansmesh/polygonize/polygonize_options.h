// Options of polygonization.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1 {

struct PolygonizeOptions {
  /// Merge the crossing points nearest to the same lattice vertex (treece1999), then place them on the surface. Off:
  /// one vertex per crossing lattice edge, as in the paper (polizelli).
  bool cluster = true;
  /// α of tejada2008, 4.4.3, 0 ≤ α < 1: before extraction, lattice vertices move away from the surface by up to α
  /// e(l)/4, where e(l) is the edge of a block of level l. Only used without clustering. 0 = off.
  double displacement = 0;
  /// Newton steps that move each vertex onto the zero set.
  int root_steps = 2;
  /// Rounds of tangential smoothing: each vertex moves towards its neighbours' mean in the tangent plane, then back
  /// onto the surface. 0 = off.
  int smoothing_rounds = 2;
  /// Move the vertices next to a crease of the field onto it.
  bool creases = true;
  /// Move the vertices off the surface so that the triangles straddle it instead of lying inside: a third of the mean
  /// distance for the same number of triangles.
  bool balance = true;
  /// Collapse edges while the quadric error stays below this (length; simplify.h). 0 = off.
  double simplify = 0;
  /// With simplify > 0: skip simplification if it would gain less than this (CollapseOptions).
  double least_gain = 0;
  /// With simplify > 0: continue to at most this number of triangles. 0 = no limit.
  std::size_t triangles = 0;
  /// If set, vertices are placed on the zero set of this field, with its normals: a field that is better near the
  /// surface but useless farther away. Must outlive the call.
  const ScalarField* placement = nullptr;
  /// Points near the surface from which it is followed (castelo2006). Sheets without a seed are not found, so seeds at
  /// the samples exclude sheets far from any sample. Empty: every block is visited.
  std::vector<Vec3> seeds;
  /// Restricts the extraction to these boxes. The mesh there equals that of the whole; it ends a few blocks beyond, in
  /// a border around which vertices deviate. Empty: no restriction.
  std::vector<Box3> regions;
  /// The surface ends in a border along the zero contour of this field, where the field becomes positive. It is clipped
  /// before simplification, at the resolution of the blocks. Blocks with ranges() above zero are skipped. Must outlive
  /// the call.
  const ScalarField* domain = nullptr;
};

}  // namespace sansmesh::inline v1
