// Function fitted to points.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sansmesh/function/surface_function.h"
#include "sansmesh/jobs/info.h"
#include "sansmesh/note.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

/// Options of preparation and fit.
struct FitFunctionOptions {
  CloudUse cloud = {};
  FitOptions fit = {};

  /// Throws ArgumentError naming the field.
  void validate() const { fit.validate(); }
};

struct FitFunctionReport {
  bool estimated_normals = false;       ///< there were none, or they were not wanted
  std::optional<OrientBy> oriented_by;  ///< from what the normals got their signs; nothing: from the input
  std::string alignment;  ///< what was done to scans, in words; empty where nothing was asked for (CloudUse::align)
  FunctionInfo function;  ///< as it was fitted
  std::optional<PaperReport> paper;  ///< of FitMethod::paper: how its blocks came to be

  static const ReportSchema& schema();
};

struct FitFunctionResult {
  SurfaceFunction function;
  FitFunctionReport report;
  std::vector<Note> notes;  ///< "preparation": of the samples
};

/// Throws DataError where the points cannot be reconstructed (fewer than 9, all coincident, collinear or in a plane),
/// ArgumentError for bad options, Cancelled.
FitFunctionResult fit_function(PointSet points, const FitFunctionOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
