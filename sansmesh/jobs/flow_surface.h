// Surfaces of an open flow from a seed curve: stream, path, streak and time surfaces.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/flow/flow_surface.h"
#include "sansmesh/jobs/flow_model.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct TraceSurfaceOptions {
  std::string seeds = {};  ///< a curve as parse_seeds reads it: needed
  /// Its kind follows from the flow where it is not given; the number of particles from the seeds, unless these are of
  /// a file.
  FlowSurfaceOptions surface = {};

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct TraceSurfaceResult {
  FlowSurface surface;
  double area = 0;  ///< of its mesh
  /// "not_finite": of seeds; "steps": of a series; "moments_meet", "too_many": what ended the surface before its end;
  /// "outside": particles that began out of the flow.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// Throws ArgumentError for bad options, FileError for seeds of a file, DataError that begins with the flow's source;
/// Cancelled.
TraceSurfaceResult trace_surface(const FlowModel& flow, const TraceSurfaceOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
