#include "sansmesh/dynamics/body_state.h"

#include <fmt/format.h>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh {
namespace {

constexpr std::size_t kStateRows = 2048;  ///< vertices a task

}  // namespace

void BodyState::explode(std::span<const Vec3> at) const {
  const bool is_implicit = options.integrator == DynamicsIntegrator::implicit_euler;
  throw DataError(fmt::format(
      "the body explodes after {:.4g} s, first at {}: take a shorter `step` than {:.4g} s, or {}", time,
      model->worst(at, names), options.step, is_implicit ? "weaker forces" : "`integrator = implicit_euler`"));
}

void BodyState::forces(std::span<const Vec3> at, std::span<const Vec3> velocities, double t, std::span<Vec3> f) {
  if (!model->forces(at, velocities, f)) explode(at);
  const double drag = options.model == SoftBodyModel::corotational ? options.mass_damping : 0;
  parallel_for(0, f.size(), kStateRows,
               [&](std::size_t i) { f[i] += weights[i] - velocities[i] * (drag * masses[i]); });
  drive.add_forces(t, f);
  const auto targets = drive.targets(t);
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const auto [vertex, stiffness] = drive.pulled()[k];
    f[vertex] += (targets[k] - at[vertex]) * stiffness;
  }
}

std::vector<Vec3> BodyState::velocities_now() {
  std::vector<Vec3> now = v;
  if (lag == 0) return now;
  std::vector<Vec3> f(size());
  forces(x, v, time, f);
  for (std::size_t i = 0; i < size(); ++i) now[i] += f[i] * (lag / masses[i]);
  for (const std::uint32_t i : drive.held()) now[i] = v[i];
  return now;
}

}  // namespace sansmesh
