// Streak and time surfaces: a sheet of particles that is refined until none is far from its neighbours.
#pragma once

#include "sansmesh/flow/flow_fronts.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Points and triangles where the particles are at the end; vertices at which several fans of triangles meet are left
/// in. The options have been checked and have a `start` and a finite `duration`, which lies in the times of the field.
FlowSheet released_sheet(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options,
                         Progress& progress);

}  // namespace sansmesh::inline v1
