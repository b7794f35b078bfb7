// How fast a body vibrates, and the steps that are short enough for it.
#pragma once

#include "sansmesh/simulate_options.h"

namespace sansmesh::inline v1 {

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

}  // namespace sansmesh::inline v1
