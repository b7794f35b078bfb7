// From what a file holds to samples that methods can use: the first half of every front door.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sansmesh/cloud_options.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/face_shape.h"
#include "sansmesh/points/sights.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct PreparedCloud {
  PointSet points;   ///< cleaned, with oriented normals; origin 0, in coordinates in which they are about 1 large
  LocalFrame frame;  ///< of these in the input; the unit is a power of two
  bool estimated_normals = false;  ///< there were none, or they were not wanted
  /// Where the normals were taken from faces that bound solids: which side is out is known of these, not judged.
  FaceSides face_sides = FaceSides::unknown;
  /// From what the normals got their signs; nothing where they have those of the input.
  std::optional<OrientBy> oriented_by = {};
  /// Of the points, in their unit, as far as it had to be estimated for the normals: saves doing so again.
  std::optional<double> noise = {}, spacing = {};
  std::vector<std::string> warnings;
  /// With `align`: what was done to the scans, in words; empty where nothing was asked for.
  std::string alignment = {};
};

/// The first half of it: cleaned, faces sampled where need be, moved and scaled; normals as they come, if there are
/// any. Throws DataError where the points cannot be used (fewer than 9, all coincident, collinear or in a plane).
PreparedCloud prepare_positions(PointSet points, FaceUse faces, Progress& progress);

/// All of it. Given normals that agree with their neighbours keep their signs, unless they point into a closed shape,
/// or away from where the samples were seen. Throws DataError as above, and as keep_classes;
/// ArgumentError for `orient_by` with normals as given.
PreparedCloud prepare_cloud(PointSet points, const CloudPreparation& use, Progress& progress);

/// For surfaces with edges: estimated normals are made sharp there (`denoise_normals`). Estimates blur edges; normals
/// that came with the samples may be exact, are only worse for it, and stay.
void sharpen_estimated_normals(PreparedCloud& cloud, Progress& progress);

}  // namespace sansmesh::inline v1
