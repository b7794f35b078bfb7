// Points moved onto the surface of samples, or new ones spread over it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/model/sample_surface.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/surface/lop.h"

namespace sansmesh::inline v1 {

struct ProjectOptions {
  /// "auto": what suits the samples, or `curvature` where options of `surface` are set; "lop": consolidation of the
  /// points, without a surface; or the name of a surface.
  std::string method = "auto";
  /// So many new points, spread evenly, instead of moving those given: 1..2·10⁹. Of lop half as many as there are by
  /// default.
  std::optional<std::size_t> points = {};
  ProjectToSurface steps = {};
  LopOptions lop = {};          ///< its `points` follow from those above
  SurfaceOptions surface = {};  ///< its method follows from `method`
  CloudUse cloud = {};          ///< of the samples

  /// All but those of `surface` and `cloud`.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field: for values out of range, and for those that mean nothing to the method.
  void validate() const;
};

/// Points, and the samples onto whose surface they move.
struct ProjectInput {
  PointSet points;
  std::string name = "the points";    ///< in messages
  std::optional<PointSet> onto = {};  ///< default: the points themselves, which denoises
  std::string onto_name = "the samples";
};

struct ProjectReport {
  std::string method;  ///< by name, as it was chosen
  /// How far points moved, unless new ones were spread; of lop only how many there are.
  SurfaceProjection moved;

  static const ReportSchema& schema();
};

struct ProjectResult {
  PointSet points;
  ProjectReport report;
  /// "surface": what there is to say of the samples and their surface, whose name the notes have.
  std::vector<Note> notes;
};

/// By project_points, resample_surface or consolidate. Throws ArgumentError for bad options, DataError that begins with
/// a name where there is no surface, or none near the points; Cancelled.
ProjectResult project(ProjectInput input, const ProjectOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
