// Surfaces of a flow from a seed curve (METHODS §5.2): stream and path surfaces by fronts of particles that advance,
// streak and time surfaces by a sheet of particles that is refined.
#pragma once

#include "sansmesh/flow/seed_curve.h"
#include "sansmesh/flow_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// The same bytes for any number of threads. Throws ArgumentError for bad options or a bad curve, DataError where no
/// part of the curve lies in the field, or the flow stands still on all of it.
FlowSurface flow_surface(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options,
                         Progress& progress);

}  // namespace sansmesh::inline v1
