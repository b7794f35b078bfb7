// Options of what is done to samples before any method.
#pragma once

#include <optional>

#include "sansmesh/option.h"
#include "sansmesh/points/point_classes.h"
#include "sansmesh/points/sights.h"

namespace sansmesh::inline v1 {

/// Where the input is a mesh or a polygon soup: its vertices as samples, or samples spread over its faces; automatic:
/// the faces where the vertices are too few or far apart to describe the surface; vertices: these, however few or flat,
/// and only the sides and normals of the faces, for what is asked at the vertices themselves.
enum class FaceUse { automatic, ignore, sample, vertices };
/// Given normals are used, and turned where they are not consistent, point inward or away from known scanners;
/// as_given: not even looked at; estimate: they are replaced.
enum class NormalUse { automatic, as_given, estimate };

/// What is done to the samples before any method.
struct CloudUse {
  FaceUse faces = FaceUse::automatic;
  NormalUse normals = NormalUse::automatic;
  /// From what normals that need it get their signs. Other than automatic: given ones get them anew, too, and DataError
  /// is thrown where nothing of the kind is known.
  OrientBy orient_by = OrientBy::automatic;
  /// Move scans that do not quite fit together onto each other (`find_scan_motions`). Where false, a warning tells of
  /// scans that disagree.
  bool align = false;
  /// Leave out samples that belong to no surface (`find_outliers`), with a warning that counts them.
  bool remove_outliers = false;
  /// Only points of these classes (`keep_classes`), the others being left out before anything else.
  std::optional<PointClasses> classes = {};

  static const OptionSchema& schema();
};

}  // namespace sansmesh::inline v1
