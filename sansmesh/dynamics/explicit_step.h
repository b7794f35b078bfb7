// What the steps of explicit integrators have in common: held vertices, and obstacles.
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
  static constexpr std::size_t kExplicitRows = 2048;  ///< vertices a task

  /// `by_velocity_before`: move() takes positions on by the velocities at the beginning, which obstacles had corrected.
  explicit ExplicitStepper(bool by_velocity_before) : by_velocity_before_(by_velocity_before) {}

  /// Positions and velocities of the free body after h seconds from body.time on.
  virtual void move(BodyState& body, double h) = 0;
  /// Held vertices are where they are at body.time, the end, others out of obstacles: what is left to do.
  virtual void arrive(BodyState& body, double h);

 private:
  int settle(BodyState& body, double h, std::span<const Vec3> held) const;
  void give_velocities(BodyState& body, double h, std::span<const Vec3> held) const;

  bool by_velocity_before_;
  std::vector<Vec3> held_before_;
};

}  // namespace sansmesh::inline v1
