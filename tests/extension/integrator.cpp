// An integrator of particles: Heun's method, with the mean of the velocities at both ends of Euler's step.
#include "sansmesh/flow/flow_integrator.h"

namespace sansmesh::inline v1 {
namespace {

void heun_step(ParticleStep& step) {
  const std::span<const Vec3> start = step.velocities(0);
  step.ask(1, [&](std::size_t i) { return start[i]; });
  const std::span<const Vec3> end = step.velocities(1);
  step.ask(1, [&](std::size_t i) { return (start[i] + end[i]) / 2; });
}

const Registered<FlowIntegrator> heun(
    {.name = "heun", .summary = "Heun's, second order", .step = heun_step, .order = 2, .reach = 0.004});

}  // namespace
}  // namespace sansmesh::inline v1
