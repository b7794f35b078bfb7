// Stream, path, streak and time lines of a flow, with attributes.
#pragma once

#include <span>

#include "sansmesh/flow_options.h"
#include "sansmesh/polyline_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// The lines, in coordinates of the field. Attributes of points: `time` (double; for streaks the time of release),
/// `speed` (float), `velocity` and `vorticity` (three floats each); of lines: `seed` (index of the seed; for time lines
/// of the moment), `length` (float) and for path lines `end` (a TraceEnd). Throws ArgumentError for bad options,
/// DataError if no seed is in the flow or nothing moves.
PolylineSet flow_lines(const VectorField& field, std::span<const Vec3> seeds, const FlowLineOptions& options,
                       Progress& progress, FlowLineReport* report = nullptr);

}  // namespace sansmesh::inline v1
