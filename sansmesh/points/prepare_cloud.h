// Cloud preparation: converts the content of a file to samples for reconstruction methods.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sansmesh/cloud_options.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/note.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/normals/sensor_directions.h"
#include "sansmesh/points/shape/face_shape.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct PreparedCloud {
  PointSet points;                 ///< cleaned samples with oriented normals; origin 0, size about 1
  LocalFrame frame;                ///< their local frame; the unit is a power of two
  bool estimated_normals = false;  ///< normals were missing or ignored
  /// Orientation of faces if normals come from faces that bound solids: exact, not estimated.
  FaceSides face_sides = FaceSides::unknown;
  /// The samples are on faces that bound solids: their surface has no border.
  bool closed_faces = false;
  /// Source of the signs of normals; absent if the input's signs were kept.
  std::optional<OrientBy> oriented_by = {};
  /// Noise and spacing of the points in local units, if they were estimated for the normals: saves another estimation.
  std::optional<double> noise = {}, spacing = {};
  std::vector<Note> notes;
  /// Result of `align` as text; empty without `align`.
  std::string alignment = {};
};

/// First half of prepare_cloud: cleaning, sampling of faces if required, translation and scaling; keeps given normals.
/// Throws DataError if the points are unusable (fewer than 9, all coincident or collinear).
PreparedCloud prepare_positions(PointSet points, FaceUse faces, Progress& progress);

/// Samples that clearly belong to no surface, if `remove_outliers` is not set.
enum class ClutterUse { keep, leave_out };

/// Removes outliers, if requested or if they are clearly clutter.
void leave_out_outliers(PreparedCloud& cloud, std::optional<bool> asked, ClutterUse clutter, Progress& progress);

/// Complete preparation. Given normals that agree with their neighbours keep their signs, unless they point into a
/// closed shape or away from the sensor. Throws DataError as prepare_positions and keep_classes; ArgumentError for
/// `orient_by` together with normals as given.
PreparedCloud prepare_cloud(PointSet points, const CloudPreparation& use, Progress& progress,
                            ClutterUse clutter = ClutterUse::keep);

/// Sharpens estimated normals at creases (`denoise_normals`), for surfaces with creases. Estimation blurs creases;
/// given normals may be exact, so they stay.
void sharpen_estimated_normals(PreparedCloud& cloud, Progress& progress);

}  // namespace sansmesh::inline v1
