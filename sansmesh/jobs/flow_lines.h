// Lines of an open flow: stream, path, streak and time lines with what is told along them.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/flow/flow_lines.h"
#include "sansmesh/jobs/flow_model.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/polyline_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct TraceLinesOptions {
  std::string seeds = {};      ///< as parse_seeds reads it; default: 200 in the box of the flow
  FlowLineOptions lines = {};  ///< `closed` follows from the seeds
  /// Other arrays of a steady volume that are told along the lines: names with commas, "all" or "none".
  std::string carry = "none";

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// The array that colours lines by default.
std::string usual_color(const FlowLineOptions& options);

struct TraceLinesResult {
  PolylineSet lines;
  FlowLineReport report;
  /// "not_finite", "reconstruction": of seeds and carried arrays; "steps": of a series; "outside": seeds out of the
  /// flow.
  std::vector<Note> notes;
};

/// Names of the arrays that the points will have. Throws ArgumentError for such as the flow has not.
std::vector<std::string> arrays_along_lines(const FlowModel& flow, const TraceLinesOptions& options);

/// Throws ArgumentError for bad options, FileError for seeds of a file, DataError that begins with the flow's source;
/// Cancelled.
TraceLinesResult trace_lines_of(const FlowModel& flow, const TraceLinesOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
