#include "sansmesh/dynamics/explicit_step.h"

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kExplicitRows = 2048;  ///< vertices a task

}  // namespace

/// Puts held vertices where they are at the end of the step, and others out of obstacles. The number that touch one.
int ExplicitStepper::finish(BodyState& body, double h, std::span<const Vec3> held) const {
  for (std::size_t k = 0; k < held.size(); ++k) {
    const std::uint32_t i = body.drive.held()[k];
    body.x[i] = held[k], body.v[i] = (held[k] - held_before_[k]) / h;
  }
  struct Found {
    int contacts = 0;
    bool sane = true;
  };
  const double most = body.longest / h;
  // Explicit Euler has moved by the velocity before, which obstacles had corrected.
  const double moved = body.options.integrator == DynamicsIntegrator::explicit_euler ? 0 : h;
  const Found found = parallel_reduce(
      body.size(), kExplicitRows, Found{},
      [&](std::size_t first, std::size_t last) {
        Found part;
        for (std::size_t i = first; i < last; ++i) {
          part.sane &= squared_norm(body.v[i]) <= most * most;
          if (body.obstacles.empty() || body.is_held[i]) continue;
          if (body.obstacles.push_out(body.x[i], body.v[i], body.near, moved)) ++part.contacts;
        }
        return part;
      },
      [](const Found& a, const Found& b) {
        return Found{a.contacts + b.contacts, a.sane && b.sane};
      });
  if (!found.sane) body.explode(body.x);
  return found.contacts;
}

void ExplicitStepper::step(BodyState& body, double h, StepReport& report) {
  const std::size_t n = body.size();
  force_.resize(n);
  std::vector<Vec3>&x = body.x, &v = body.v;
  const std::vector<double>& m = body.masses;
  const auto positions = body.drive.held_positions(body.time);
  held_before_.assign(positions.begin(), positions.end());
  const double t = body.time, end = t + h;

  switch (body.options.integrator) {
    case DynamicsIntegrator::explicit_euler:
      body.forces(x, v, t, force_);
      parallel_for(0, n, kExplicitRows, [&](std::size_t i) {
        x[i] += v[i] * h;
        v[i] += force_[i] * (h / m[i]);
      });
      break;
    case DynamicsIntegrator::verlet: {
      // x(t + h) = 2 x(t) − x(t − h) + h² a(t), where v is (x(t) − x(t − h)) / h: that of half a step before.
      body.forces(x, v, t, force_);
      const double gained = 0.5 * h + body.lag;  // the first step, and one of another length: from half its own before
      parallel_for(0, n, kExplicitRows, [&](std::size_t i) {
        v[i] += force_[i] * (gained / m[i]);
        x[i] += v[i] * h;
      });
      body.lag = 0.5 * h;
      break;
    }
    default:  // velocity Verlet
      guess_.resize(n);
      if (!known_) body.forces(x, v, t, force_);
      parallel_for(0, n, kExplicitRows, [&](std::size_t i) {
        const Vec3 gain = force_[i] * (0.5 * h / m[i]);
        v[i] += gain;
        x[i] += v[i] * h;
        guess_[i] = v[i] + gain;  // at the end, for damping
      });
      break;
  }
  body.time = end;
  const auto held = body.drive.held_positions(end);
  report.contacts = finish(body, h, held);
  if (body.options.integrator == DynamicsIntegrator::velocity_verlet) {
    for (const std::uint32_t i : body.drive.held()) guess_[i] = v[i];
    body.forces(x, guess_, end, force_);
    parallel_for(0, n, kExplicitRows, [&](std::size_t i) {
      v[i] += force_[i] * (0.5 * h / m[i]);
      if (!body.obstacles.empty() && !body.is_held[i]) body.obstacles.push_out(x[i], v[i], body.near, 0);
    });
    for (std::size_t k = 0; k < held.size(); ++k) {
      v[body.drive.held()[k]] = (held[k] - held_before_[k]) / h;
    }
    known_ = true;
  }
  report.time = body.time, report.parts += 1;
}

}  // namespace sansmesh::inline v1
