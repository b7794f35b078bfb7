// Streak and time surfaces by an adaptively refined sheet of particles.
#pragma once

#include "sansmesh/flow/flow_sheet.h"
#include "sansmesh/flow/seed_curve.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Points and triangles at the particles' final positions; vertices shared by several fans of triangles are not
/// separated. The options are valid and have a `start` and a finite `duration` within the times of the field.
FlowSheet released_sheet(const VectorField& field, const SeedCurve& curve, const FlowSurfaceOptions& options,
                         Progress& progress);

}  // namespace sansmesh::inline v1
