// Integrators of constant step length: Euler's and the classical Runge–Kutta method.
#include "sansmesh/flow/flow_integrator.h"

namespace sansmesh::inline v1 {
namespace {

void euler_step(ParticleStep& step) {
  step.ask(1, [start = step.velocities(0)](std::size_t i) { return start[i]; });
}

void runge_kutta_step(ParticleStep& step) {
  const std::span<const Vec3> start = step.velocities(0);
  step.ask(0.5, [&](std::size_t i) { return start[i] * 0.5; });
  const std::span<const Vec3> middle = step.velocities(1);
  step.ask(0.5, [&](std::size_t i) { return middle[i] * 0.5; });
  const std::span<const Vec3> again = step.velocities(2);
  step.ask(1, [&](std::size_t i) { return again[i]; });
  const std::span<const Vec3> end = step.velocities(3);
  step.ask(1, [&](std::size_t i) { return (start[i] + (middle[i] + again[i]) * 2 + end[i]) / 6; });
}

constexpr FlowIntegrator kRungeKutta[] = {
    {.name = "euler", .summary = "first order, as in the source", .step = euler_step, .order = 1},
    {.name = "rk4", .summary = "classical Runge-Kutta, fourth order", .step = runge_kutta_step, .order = 4}};

}  // namespace

std::span<const FlowIntegrator> runge_kutta_integrators() { return kRungeKutta; }

}  // namespace sansmesh::inline v1
