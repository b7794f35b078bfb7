// A step of the explicit methods: Euler's, Verlet's, velocity Verlet's.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/dynamics/body_state.h"

namespace sansmesh::inline v1 {

class ExplicitStepper {
 public:
  /// One after the other, of the same body and the same method. Throws DataError where the body explodes.
  void step(BodyState& body, double h, StepReport& report);
  /// The body is not where it was left.
  void reset() { known_ = false; }

 private:
  int finish(BodyState& body, double h, std::span<const Vec3> held) const;

  std::vector<Vec3> force_, guess_, held_before_;
  bool known_ = false;  ///< velocity Verlet: force_ is that at the body's positions
};

}  // namespace sansmesh::inline v1
