// Tubes around polylines.
#pragma once

#include "sansmesh/polyline_set.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct TubeOptions {
  double radius = 0;  ///< circumradius of the cross-sections, > 0 (length)
  int sides = 8;      ///< sides of a cross-section, 3..256
  /// Skips points nearer than this to the previous one, except the end of a line (length, >= 0); at least a thousandth
  /// of the radius.
  double least_step = 0;
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Makes a closed, outward tube with flat ends for each line, in order; tubes that meet overlap. Cross-sections rotate
/// minimally between segments, so that the tube does not twist: of the double reflection [wang2008], a polyline needs
/// only one, in the plane of the mitre.
///
/// Bends up to 45° are mitred: the tube keeps its width on both sides. At sharper bends, or if the adjacent segments
/// are too short for a mitre, cross-sections rotate about the point, and the outer side is part of a sphere. Folds are
/// inside the tube: no corner is farther from the line than `radius`, or 1.083 times that at mitres. Closed lines are
/// capped like others.
///
/// Points that are not finite end a tube, and the next point begins another. Lines and parts with one point, or within
/// the least step of their first point, make no tube.
///
/// Vertices have the normals of the round tube and the attributes of their points, triangles those of their line.
/// Throws ArgumentError for invalid options, DataError for more vertices than a mesh can have.
TriangleMesh tubes(const PolylineSet& lines, const TubeOptions& options);

}  // namespace sansmesh::inline v1
