#include "sansmesh/dynamics/body_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kStateRows = 2048;  ///< vertices per task

}  // namespace

double BodyState::largest_eigenvalue(double h, double unit, bool handles) {
  constexpr int kIterations = 60;
  const std::size_t n = size();
  std::vector<Vec3> p(n), q(n);
  model->linearize(rest, h, q);
  for (std::size_t i = 0; i < n; ++i) {
    const double sign = names[i] % 2 ? 1 : -1;  // any vector with a component of the fastest vibration
    p[i] = Vec3{sign, 0.5 + 0.1 * static_cast<double>(i % 7), sign * (0.3 + 0.1 * static_cast<double>(i % 5))};
  }
  double eigenvalue = 0;
  for (int k = 0; k < kIterations; ++k) {
    double size = 0;  // norm weighted by M
    for (std::size_t i = 0; i < n; ++i) size += is_held[i] ? 0 : masses[i] * squared_norm(p[i]);
    const double scale = size > 0 ? 1 / std::sqrt(size) : 0;
    for (std::size_t i = 0; i < n; ++i) p[i] *= is_held[i] ? 0 : scale, q[i] = {};
    parallel_ranges(0, n, kStateRows, [&](std::size_t first, std::size_t last) { model->add_rows(first, last, p, q); });
    for (Vec3& a : q) a *= 1 / unit;
    if (handles) {
      for (const PulledVertex& pulled : drive.pulled()) q[pulled.vertex] += p[pulled.vertex] * pulled.stiffness;
    }
    eigenvalue = 0;
    for (std::size_t i = 0; i < n; ++i) {
      eigenvalue += dot(p[i], q[i]);
      p[i] = q[i] / masses[i];
    }
  }
  return eigenvalue;
}

double BodyState::stable_step() {
  if (!integrator.stable_step) return std::numeric_limits<double>::infinity();
  // The matrix h² K + h D is dominated by K for a long step, by D for a short one.
  constexpr double kLong = 1e6, kShort = 1e-9;
  const bool springs = options.model == SoftBodyModel::springs;
  VibrationBounds found;
  found.frequency = largest_eigenvalue(kLong, kLong * kLong, true);
  for (const PulledVertex& p : drive.pulled()) {
    found.handles = std::max(found.handles, p.stiffness / masses[p.vertex]);
  }
  found.uniform_decay = springs ? 0 : options.mass_damping;
  found.relative_decay = springs ? options.damping / options.stiffness : options.stiffness_damping;
  found.decay = found.uniform_decay;
  if (found.relative_decay > 0) found.decay += largest_eigenvalue(kShort, kShort, false);
  return 0.9 * sansmesh::stable_step(integrator, found);
}

void BodyState::explode(std::span<const Vec3> at) {
  const std::string what = fmt::format("the body explodes after {:.4g} s, first at {}", time, model->worst(at, names));
  if (!integrator.stable_step) {
    throw DataError(fmt::format("{}: take a shorter `step` than {:.4g} s, or weaker forces", what, options.step));
  }
  const double stable = stable_step();
  if (!(stable > 0)) {
    throw DataError(
        fmt::format("{}: {} is unstable without damping for any `step`: take "
                    "`integrator = velocity-verlet` or `implicit-euler`",
                    what, integrator.name));
  }
  throw DataError(fmt::format("{}: take a `step` of {:.2g} s (now {:.4g} s), or `integrator = implicit-euler`", what,
                              stable < options.step ? stable : options.step / 4, options.step));
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

}  // namespace sansmesh::inline v1
