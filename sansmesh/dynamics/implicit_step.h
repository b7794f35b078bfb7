// A step of implicit Euler (METHODS §7.2; thesis equation 6.43; [baraff1998]).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/dynamics/block_solver.h"
#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/dynamics/body_state.h"

namespace sansmesh::inline v1 {

/// A vertex and the obstacle that it rests on.
struct VertexTouch {
  static constexpr std::int32_t kNone = -1, kHeld = -2;  ///< kHeld: its motion is given
  std::int32_t obstacle = kNone;
  bool sliding = false;  ///< else it sticks where there is friction
  bool settled = false;  ///< has stuck again in this step: not asked a second time
  double load = 0;       ///< the obstacle's push in a step, N s
  Vec3 drag;             ///< unit, the direction of friction
};

class ImplicitStepper : public BodyStepper {
 public:
  /// In parts where conjugate gradients do not converge. Throws DataError where they never do, or the body explodes.
  void step(BodyState& body, double h, StepReport& report) override;
  void reset() override { touches_.clear(); }

 private:
  bool part(BodyState& body, double h, StepReport& report);
  void set_up(BodyState& body, double h, std::span<const Vec3> held);
  bool falls() const;  ///< no vertex is held or at an obstacle
  void keep_momentum();
  void constrain(const BodyState& body, double h);
  bool revise_contacts(const BodyState& body, double h);
  void take_over(BodyState& body, double h, std::span<const Vec3> held, StepReport& report);

  BlockSolver solver_;
  std::vector<double> diagonal_;
  std::vector<Vec3> force_;     ///< elastic
  std::vector<Vec3> external_;  ///< impulse of all others
  std::vector<Vec3> momentum_;
  std::vector<Vec3> base_;      ///< right-hand side without friction
  std::vector<Vec3> right_;     ///< with it
  std::vector<Vec3> wanted_;    ///< velocities at the end
  std::vector<Vec3> reaction_;  ///< impulses of what constrains vertices
  std::vector<VertexConstraint> constraints_;
  std::vector<VertexTouch> touches_, touches_before_;
  int level_ = 0, calm_ = 0;  ///< halvings of the next part; parts since one failed
};

}  // namespace sansmesh::inline v1
