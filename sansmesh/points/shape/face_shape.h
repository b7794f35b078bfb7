// Shape information from the faces of a mesh: orientation, thin parts, and whether to sample the faces.
#pragma once

#include <cstddef>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

enum class FaceSides {
  unknown,  ///< the faces bound no solid, or are inconsistent
  outward,
  inward,
};

/// Orientation of face normals (counter-clockwise faces point towards the viewer). Known if the faces bound solids: all
/// but a hundredth of the edges have two triangles of opposite direction, and every part of negative volume is a cavity
/// in the box of a larger part. O(n) in time and memory.
FaceSides face_sides(const PointSet& mesh);

/// Parts where the opposite side is as close as neighbouring vertices of the same side, so that a neighbourhood mixes
/// both sides.
struct ThinParts {
  double share = 0;      ///< share of the area, 0..1
  double thickness = 0;  ///< median thickness of thin parts (length); 0 if there are none
};

/// Tests about 4000 points evenly distributed over the area. A point is thin if behind it, within one and a half times
/// the longest edge of the triangle, there is a vertex whose faces have the opposite direction. Edges count up to
/// `longest` (length > 0).
ThinParts find_thin_parts(const PointSet& mesh, double longest);

/// Number of face samples if the vertices do not determine it.
constexpr std::size_t kFaceSamples = 400000;

/// Whether every edge has two triangles of opposite direction: the faces bound solids.
bool faces_are_closed(const PointSet& mesh);

/// Whether the vertices sample the faces completely, as in meshed scans but not in CAD models and polygon soups: at
/// least 1000 vertices, and nearly all of the area in triangles with edges short against the mean spacing of the
/// vertices.
bool vertices_are_dense(const PointSet& mesh);

/// Number of face samples required to describe a mesh, or 0 if its vertices suffice: they are dense, they are not on
/// creases, where their normals are means over faces that differ, and hardly any area is so thin that vertices of the
/// other side are equally close (`find_thin_parts`). Creases: sharp edges that continue in line, as those of machine
/// parts; then ten per vertex. For a mesh that is too thin: enough samples for a spacing of a fraction of its
/// thickness, at least two per vertex. A mesh with both: `kFaceSamples`. At most the larger of `kFaceSamples` and two
/// per vertex. A closed mesh counts as thin from a smaller share of its area on.
std::size_t face_samples_wanted(const PointSet& mesh);

}  // namespace sansmesh::inline v1
