// Streak and time surfaces: a sheet of particles that is refined until none is far from its neighbours.
#pragma once

#include "sansmesh/core/progress.h"
#include "sansmesh/flow/flow_fronts.h"

namespace sansmesh {

/// Points and triangles where the particles are at the end; vertices at which several fans of triangles meet are left
/// in. The options have been checked and have a `start` and a finite `duration`, which lies in the times of the field.
FlowSheet released_sheet(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options,
                         Progress& progress);

}  // namespace sansmesh
