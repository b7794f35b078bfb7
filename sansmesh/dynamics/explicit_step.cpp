#include "sansmesh/dynamics/explicit_step.h"

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {

/// Sets the velocities of held vertices from their prescribed motion.
void ExplicitStepper::give_velocities(BodyState& body, double h, std::span<const Vec3> held) const {
  for (std::size_t k = 0; k < held.size(); ++k) body.v[body.drive.held()[k]] = (held[k] - held_before_[k]) / h;
}

/// Moves held vertices to their positions at the end of the step, and the others out of obstacles. Returns the number
/// of contacts.
int ExplicitStepper::settle(BodyState& body, double h, std::span<const Vec3> held) const {
  for (std::size_t k = 0; k < held.size(); ++k) body.x[body.drive.held()[k]] = held[k];
  give_velocities(body, h, held);
  struct Found {
    int contacts = 0;
    bool sane = true;
  };
  const double most = body.longest / h;
  const double moved = by_velocity_before_ ? 0 : h;
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

void ExplicitStepper::arrive(BodyState& /*body*/, double /*h*/) {}

void ExplicitStepper::step(BodyState& body, double h, StepReport& report) {
  const auto before = body.drive.held_positions(body.time);
  held_before_.assign(before.begin(), before.end());
  move(body, h);
  body.time += h;
  const auto held = body.drive.held_positions(body.time);
  report.contacts = settle(body, h, held);
  arrive(body, h);
  give_velocities(body, h, held);
  report.time = body.time, report.parts += 1, report.shortest = h;
}

}  // namespace sansmesh::inline v1
