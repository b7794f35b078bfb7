// The longest steps that integrators are stable with.
#pragma once

#include "sansmesh/simulate_options.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// About the longest step, s, with which options.integrator is stable for small motions of the body about rest:
/// infinity of implicit Euler; of explicit Euler 0 where nothing damps, or handles hang on springs that nothing damps.
/// options.step does not count. Throws as SoftBody does. What turns or is under load needs a little less: half of it is
/// safe.
double stable_step(const TetMesh& mesh, const SoftBodyOptions& options, const DynamicsScene& scene = {});

}  // namespace sansmesh::inline v1
