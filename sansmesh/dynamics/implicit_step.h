// A step of implicit Euler (tejada2008, equation 6.43; baraff1998).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/dynamics/block_solver.h"
#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/dynamics/body_state.h"

namespace sansmesh::inline v1 {

/// Contact of a vertex with an obstacle.
struct VertexTouch {
  static constexpr std::int32_t kNone = -1, kHeld = -2;  ///< kHeld: its motion is prescribed
  std::int32_t obstacle = kNone;
  bool sliding = false;  ///< else it sticks if there is friction
  bool settled = false;  ///< has stuck again in this step and is not tested a second time
  double load = 0;       ///< normal impulse of the obstacle in a step, N s
  Vec3 drag;             ///< unit direction of friction
};

class ImplicitStepper : public BodyStepper {
 public:
  /// Divides the step where conjugate gradients do not converge. Throws DataError where they never do, or the body
  /// explodes.
  void step(BodyState& body, double h, StepReport& report) override;
  void reset() override { touches_.clear(); }

 private:
  bool part(BodyState& body, double h, StepReport& report);
  void set_up(BodyState& body, double h, std::span<const Vec3> held);
  bool falls() const;  ///< no vertex is held or in contact
  void keep_momentum();
  void constrain(const BodyState& body, double h);
  bool revise_contacts(const BodyState& body, double h);
  void take_over(BodyState& body, double h, std::span<const Vec3> held, StepReport& report);

  BlockSolver solver_;
  std::vector<double> diagonal_;
  std::vector<Vec3> force_;     ///< elastic forces
  std::vector<Vec3> external_;  ///< impulse of all other forces
  std::vector<Vec3> momentum_;
  std::vector<Vec3> base_;      ///< right-hand side without friction
  std::vector<Vec3> right_;     ///< right-hand side with friction
  std::vector<Vec3> wanted_;    ///< velocities at the end
  std::vector<Vec3> reaction_;  ///< impulses of constraints
  std::vector<VertexConstraint> constraints_;
  std::vector<VertexTouch> touches_, touches_before_;
  int level_ = 0, calm_ = 0;  ///< halvings of the next substep; substeps since a failure
};

}  // namespace sansmesh::inline v1
