// Surfaces that flow from a seed curve (tejada2008, 5.3): stream and path surfaces by advancing fronts of particles,
// streak and time surfaces by an adaptively refined sheet of particles.
#pragma once

#include "sansmesh/flow/seed_curve.h"
#include "sansmesh/flow_options.h"
#include "sansmesh/progress.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// Byte-identical for any number of threads. Throws ArgumentError for bad options or a bad curve, DataError if no part
/// of the curve is in the field, or the flow is at rest on all of it.
FlowSurface flow_surface(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options,
                         Progress& progress);

}  // namespace sansmesh::inline v1
