// Lines as tubes.
#pragma once

#include "sansmesh/polyline_set.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct TubeOptions {
  double radius = 0;  ///< of the corners of cross-sections, > 0 (length)
  int sides = 8;      ///< of a cross-section, 3..256
  /// Points nearer than this to the last one are left out, but the end of a line (length, >= 0). A thousandth of the
  /// radius at least.
  double least_step = 0;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Each line as a closed tube with flat ends, outward; one after the other, and where they meet they overlap. Its
/// cross-sections turn from segment to segment by the least rotation, so it does not twist: double reflection
/// [wang2008], of which a polyline leaves one, in the plane of the mitre.
///
/// Bends up to 45° are mitred: the tube is as wide as its radius on both sides. Where a bend is sharper, or the
/// segments at it are too short for their mitre, cross-sections turn about the point instead, and the outer side is
/// part of a ball. What folds then lies within the tube: no corner is farther from the line than `radius`, those of
/// mitres 1.083 times that. Lines that end where they began are capped like others.
///
/// Points that are not finite end a tube, and the next one begins another. Lines and parts of one point, or that stay
/// within the least step of their first one, become nothing.
///
/// Vertices have the normals of the round tube, and the attributes of their points as they are; triangles those of
/// their line. Throws ArgumentError for bad options, DataError for more vertices than a mesh can have.
TriangleMesh tubes(const PolylineSet& lines, const TubeOptions& options);

}  // namespace sansmesh::inline v1
