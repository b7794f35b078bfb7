// Lines of a flow with all that is told along them: stream, path, streak and time lines.
#pragma once

#include <span>

#include "sansmesh/flow_options.h"
#include "sansmesh/polyline_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// The lines, in coordinates of the field. Attributes of points: `time` (double; of streaks when the
/// particle left), `speed` (float), `velocity` and
/// `vorticity` (three floats each); of lines: `seed` (number of the seed; of time lines that of the moment), `length`
/// (float) and of path lines `end` (a TraceEnd). Throws ArgumentError for bad options, DataError where no seed lies in
/// the flow or nothing moves.
PolylineSet flow_lines(const VectorField& field, std::span<const Vec3> seeds, const FlowLineOptions& options,
                       Progress& progress, FlowLineReport* report = nullptr);

}  // namespace sansmesh::inline v1
