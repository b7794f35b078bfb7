// The longest steps that integrators are stable with.
#pragma once

#include "sansmesh/data/tet_mesh.h"
#include "sansmesh/dynamics/soft_body_options.h"

namespace sansmesh {

/// The body's vibrations at rest, bounded: every motion of it has a frequency and a decay within these.
struct VibrationBounds {
  double frequency = 0;       ///< ω², 1/s², of the fastest, springs of handles included
  double handles = 0;         ///< the largest of these alone, stiffness over mass, 1/s²
  double decay = 0;           ///< c of ẍ = −ω² x − c ẋ, 1/s: the largest
  double uniform_decay = 0;   ///< the part of c that all motions have, 1/s
  double relative_decay = 0;  ///< c is at least so many seconds times the ω² of the body itself
};

/// The longest step, s, with which a method is stable for all motions within these bounds: infinity of implicit Euler;
/// of explicit Euler 0 where nothing damps, or handles hang on springs that nothing damps.
double stable_step(DynamicsIntegrator integrator, const VibrationBounds& bounds);

/// About the longest step, s, with which options.integrator is stable for small motions of the body about rest: 0.9 of
/// the above. options.step does not count. Throws as SoftBody does. What turns or is under load needs a little less:
/// half of it is safe.
double stable_step(const TetMesh& mesh, const SoftBodyOptions& options, const DynamicsScene& scene = {});

}  // namespace sansmesh
