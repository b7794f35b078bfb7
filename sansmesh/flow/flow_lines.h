// Lines of a flow with all that is told along them: stream, path, streak and time lines.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/flow/trace.h"
#include "sansmesh/option.h"
#include "sansmesh/polyline_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

enum class FlowLineKind : std::uint8_t {
  path,    ///< where one particle goes; in a steady flow the stream line
  streak,  ///< where all those are that left one place one after the other: dye, smoke
  time     ///< where those are that left together, at several moments
};

struct FlowLineOptions {
  FlowLineKind kind = FlowLineKind::path;
  FlowDirection direction = FlowDirection::forward;  ///< `both` is for path lines
  /// Moment at which particles leave. Default: the field's first (backward: last) one, 0 where it has none.
  std::optional<double> start;
  /// Of path lines and streaks until the end of the field, of others to be given: time, > 0. Default where neither this
  /// nor `length` is given: as long as lines of five diagonals of the field's bounds take.
  std::optional<double> duration;
  std::optional<double> length;    ///< of path lines, > 0 (length)
  std::optional<double> interval;  ///< streak: between particles; time: between lines (time, > 0). Default: a hundredth
                                   ///< of the duration, of time lines a tenth
  bool closed = false;             ///< time lines: the seeds are a closed curve
  TraceOptions trace;              ///< but its direction, duration and length

  /// Without `closed`, which the seeds say.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct FlowLineReport {
  std::size_t seeds = 0, outside = 0;
  std::array<std::size_t, 6> ends{};  ///< of path lines, by TraceEnd
  double longest = 0;                 ///< length

  static const ReportSchema& schema();
};

/// The lines, in coordinates of the field. Attributes of points: `time` (double; of streaks when the
/// particle left), `speed` (float), `velocity` and
/// `vorticity` (three floats each); of lines: `seed` (number of the seed; of time lines that of the moment), `length`
/// (float) and of path lines `end` (a TraceEnd). Throws ArgumentError for bad options, DataError where no seed lies in
/// the flow or nothing moves.
PolylineSet flow_lines(const VectorField& field, std::span<const Vec3> seeds, const FlowLineOptions& options,
                       Progress& progress, FlowLineReport* report = nullptr);

}  // namespace sansmesh::inline v1
