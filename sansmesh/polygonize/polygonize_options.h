// How a mesh is cut out of a field.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1 {

struct PolygonizeOptions {
  /// Merge the crossing points nearest to the same lattice vertex (after Treece, Prager & Gee 1999, "Regularised
  /// marching tetrahedra"), then place them on the surface. Off: one vertex a crossing lattice edge, as in the paper.
  bool cluster = true;
  /// α of METHODS §3.3, 0 ≤ α < 1: lattice vertices are moved away from the surface by up to α e(l)/4 before
  /// extraction. Only meaningful without clustering. 0 = off.
  double displacement = 0;
  /// Newton steps that put each vertex on the zero set.
  int root_steps = 2;
  /// Rounds of tangential smoothing (each vertex moves towards its neighbours' mean in the tangent plane, then back
  /// onto the surface). 0 = off.
  int smoothing_rounds = 2;
  /// Move the vertices next to a crease of the field onto it.
  bool creases = true;
  /// Move the vertices off the surface by so little that the triangles straddle it instead of lying inside: a third of
  /// the mean distance for the same number of triangles.
  bool balance = true;
  /// Collapse edges while the quadric error stays below this (length; simplify.h): few triangles where the surface is
  /// flat, at any scale. 0 = off.
  double simplify = 0;
  /// With simplify > 0: leave it if it would not bring much (CollapseOptions).
  double least_gain = 0;
  /// With simplify > 0: go on until there are no more triangles than this. 0 = not.
  std::size_t triangles = 0;
  /// Vertices are placed on the zero set of this field, with its normals, if it is not the one that the mesh is cut out
  /// of: one that is better next to the surface but of no use farther away. Must outlive the call.
  const ScalarField* placement = nullptr;
  /// Points near the surface from which it is followed (METHODS §3.2): sheets that no seed leads to are not found, so
  /// seeds at the samples keep sheets far from any sample out. Empty: every block is looked at.
  std::vector<Vec3> seeds;
  /// Only the surface in these boxes: the mesh is as that of the whole there, and ends a few blocks beyond in a border
  /// around which its vertices are not quite where they would be. None: all of it.
  std::vector<Box3> regions;
  /// The surface ends where this field becomes positive, in a border along the contour where it passes zero: it is cut
  /// off there before it is simplified, as finely as the blocks are. Blocks where its ranges() are above zero are not
  /// even looked at. Must outlive the call.
  const ScalarField* domain = nullptr;
};

}  // namespace sansmesh::inline v1
