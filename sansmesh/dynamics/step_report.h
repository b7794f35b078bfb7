// What integrators tell.
#pragma once

namespace sansmesh::inline v1 {

/// What a step took.
struct StepReport {
  double time = 0;      ///< s, at its end
  double shortest = 0;  ///< s, of its parts where it was halved, else the step
  int parts = 0;        ///< in how many it was made: 1 where it was not halved
  int halvings = 0;     ///< times that conjugate gradients did not converge
  int solves = 0;       ///< systems, more than parts where contacts were found or lost
  int iterations = 0;   ///< of conjugate gradients, all together; 0 of explicit methods
  int contacts = 0;     ///< vertices that touch obstacles at its end
  int unsettled = 0;    ///< parts after whose last system contacts would still change
};

}  // namespace sansmesh::inline v1
