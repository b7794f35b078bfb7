// Stability limits of time integrators.
#pragma once

#include "sansmesh/simulate_options.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// Approximately the longest step, s, with which options.integrator is stable for small motions about rest: infinity
/// for implicit Euler; for explicit Euler 0 without damping, or if undamped springs hold handles. options.step is
/// ignored. Throws as SoftBody does. Rotating or loaded bodies need slightly less; half of it is safe.
double stable_step(const TetMesh& mesh, const SoftBodyOptions& options, const DynamicsScene& scene = {});

}  // namespace sansmesh::inline v1
