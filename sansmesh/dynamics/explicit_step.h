// Common part of explicit steps: held vertices and obstacles.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/dynamics/body_state.h"

namespace sansmesh::inline v1 {

class ExplicitStepper : public BodyStepper {
 public:
  void step(BodyState& body, double h, StepReport& report) final;

 protected:
  static constexpr std::size_t kExplicitRows = 2048;  ///< vertices per task

  /// `by_velocity_before`: move() advances positions with the initial velocities, which obstacles have corrected.
  explicit ExplicitStepper(bool by_velocity_before) : by_velocity_before_(by_velocity_before) {}

  /// Positions and velocities of the free body h seconds after body.time.
  virtual void move(BodyState& body, double h) = 0;
  /// Called at the end of the step, when held vertices are in place and the others outside obstacles.
  virtual void arrive(BodyState& body, double h);

 private:
  int settle(BodyState& body, double h, std::span<const Vec3> held) const;
  void give_velocities(BodyState& body, double h, std::span<const Vec3> held) const;

  bool by_velocity_before_;
  std::vector<Vec3> held_before_;
};

}  // namespace sansmesh::inline v1
