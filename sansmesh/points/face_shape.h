// What the faces of a mesh tell of the shape that its vertices alone do not: which side is out, where it is thin, and
// whether faces are wanted as samples.
#pragma once

#include <cstddef>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

enum class FaceSides {
  unknown,  ///< the faces bound no solid, or do not agree on its inside
  outward,
  inward,
};

/// Which way the normals of the faces look, counter-clockwise ones towards the viewer. Known where the faces bound
/// solids: all but a hundredth of the edges have two triangles that pass them in opposite directions, and every part
/// that encloses less than nothing is a cavity, in the box of a larger one. O(n) in time and memory.
FaceSides face_sides(const PointSet& mesh);

/// Where the opposite side is as near as the vertices of this side are to each other, neighbours do not tell the two
/// apart.
struct ThinParts {
  double share = 0;      ///< of the area, 0..1
  double thickness = 0;  ///< in the median there (length); 0 where nothing is thin
};

/// Asked at some 4000 places spread evenly over the area: thin are those behind which, no deeper than one and a half
/// times the longest edge of the triangle, there is a vertex whose faces look the other way. Edges count up to
/// `longest` (length > 0).
ThinParts find_thin_parts(const PointSet& mesh, double longest);

/// Samples of the faces of a mesh whose vertices tell nothing of how many it takes.
constexpr std::size_t kFaceSamples = 400000;

/// Whether the vertices are samples of all of the faces, as those of meshed scans are, and not those of CAD models and
/// polygon soups: there are at least 1000, and nearly all of the area is in triangles whose edges are not long against
/// the mean spacing of the vertices.
bool vertices_are_dense(const PointSet& mesh);

/// How many samples of its faces describe a mesh that its vertices do not describe; 0 where these suffice: they are
/// dense, and hardly any of the area is so thin that vertices of the other side are as near (`find_thin_parts`). Of a
/// mesh that is only too thin, samples for a fraction of its thickness are wanted, at least two for each vertex and no
/// more than `kFaceSamples`, or those two.
std::size_t face_samples_wanted(const PointSet& mesh);

}  // namespace sansmesh::inline v1
