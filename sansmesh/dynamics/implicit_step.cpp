// A step of implicit Euler (tejada2008, equation 6.43; baraff1998).
#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/dynamics/block_solver.h"
#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/dynamics/body_state.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kImplicitRows = 2048;  ///< vertices per task
constexpr int kContactPasses = 6;    ///< largest number of systems solved until contacts agree with the solution
constexpr int kCalmParts = 4;        ///< successive convergent substeps before a longer one is tried
constexpr double kRounding = 1e-12;  ///< lower bound of attainable residuals of momentum and forces
constexpr double kSameLoad = 0.1;    ///< relative change of a load that friction ignores

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

/// The system for the velocities at the end, (M − h ∂f/∂v − h² ∂f/∂x) (v + Δv) = M v + h f with f without damping:
/// tejada2008, equation 6.43, for Δv plus the matrix times v on both sides.
void ImplicitStepper::set_up(BodyState& body, double h, std::span<const Vec3> held) {
  const std::size_t n = body.size();
  for (auto* list : {&force_, &external_, &momentum_, &base_, &right_, &wanted_, &reaction_}) list->resize(n);
  diagonal_.resize(n), constraints_.assign(n, {}), touches_.resize(n);
  if (!body.model->linearize(body.x, h, force_)) body.explode(body.x);

  external_ = body.weights;
  body.drive.add_forces(body.time + 0.5 * h, external_);
  const double drag = body.options.model == SoftBodyModel::corotational ? 1 + h * body.options.mass_damping : 1;
  parallel_for(0, n, kImplicitRows, [&](std::size_t i) { diagonal_[i] = drag * body.masses[i]; });
  const auto targets = body.drive.targets(body.time + h);
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const auto [vertex, stiffness] = body.drive.pulled()[k];
    external_[vertex] += (targets[k] - body.x[vertex]) * stiffness;
    diagonal_[vertex] += h * h * stiffness;
  }
  // Initial guess: for an unconstrained falling body, the velocity with that of the fall.
  const bool free = held.empty() && falls();
  parallel_for(0, n, kImplicitRows, [&](std::size_t i) {
    external_[i] *= h;
    momentum_[i] = body.v[i] * body.masses[i];
    base_[i] = momentum_[i] + force_[i] * h + external_[i];
    wanted_[i] = free ? body.v[i] + external_[i] / diagonal_[i] : body.v[i];
    touches_[i].settled = false;
  });
  for (std::size_t k = 0; k < held.size(); ++k) {
    const std::uint32_t i = body.drive.held()[k];
    constraints_[i].kind = VertexConstraint::Kind::held;
    wanted_[i] = (held[k] - body.x[i]) / h;
    touches_[i].obstacle = VertexTouch::kHeld;
  }
  solver_.prepare(*body.model, diagonal_);
}

bool ImplicitStepper::falls() const {
  return std::all_of(touches_.begin(), touches_.end(),
                     [](const VertexTouch& touch) { return touch.obstacle == VertexTouch::kNone; });
}

/// Makes the sum of all equations exact for any tolerance. The model's matrix is zero on translations, so the sum is
/// that of Σ d w = Σ b; a translation satisfies it with the least error.
void ImplicitStepper::keep_momentum() {
  struct Sums {
    Vec3 missing;
    double mass = 0;
  };
  const Sums all = parallel_reduce(
      wanted_.size(), kImplicitRows, Sums{},
      [&](std::size_t first, std::size_t last) {
        Sums part;
        for (std::size_t i = first; i < last; ++i) {
          part.missing += right_[i] - wanted_[i] * diagonal_[i], part.mass += diagonal_[i];
        }
        return part;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a.missing + b.missing, a.mass + b.mass};
      });
  const Vec3 gain = all.missing / all.mass;
  parallel_for(0, wanted_.size(), kImplicitRows, [&](std::size_t i) { wanted_[i] += gain; });
}

/// Contacts as constraints of the solver; friction of sliding contacts as impulses.
void ImplicitStepper::constrain(const BodyState& body, double h) {
  right_ = base_;
  if (body.obstacles.empty()) return;
  parallel_for(0, body.size(), kImplicitRows, [&](std::size_t i) {
    const VertexTouch& touch = touches_[i];
    if (touch.obstacle == VertexTouch::kHeld) return;
    constraints_[i] = {};
    if (touch.obstacle == VertexTouch::kNone) return;
    const auto obstacle = static_cast<std::size_t>(touch.obstacle);
    const auto [distance, normal] = body.obstacles.side(obstacle, body.x[i]);
    const Vec3 given = normal * (-distance / h);  // arrives on the surface
    const double friction = body.obstacles.friction(obstacle);
    const bool sticks = friction > 0 && !touch.sliding;
    constraints_[i] = {sticks ? VertexConstraint::Kind::held : VertexConstraint::Kind::plane, normal};
    wanted_[i] = constraints_[i].filter(wanted_[i]) + given;
    if (!sticks) right_[i] += touch.drag * (friction * touch.load);
  });
}

/// Checks whether the obstacles push, and hold by friction, no more than possible, and whether other vertices penetrate
/// them. Returns false if all contacts were consistent.
bool ImplicitStepper::revise_contacts(const BodyState& body, double h) {
  solver_.multiply(wanted_, reaction_);
  const auto revise = [&](std::size_t i) {
    VertexTouch& touch = touches_[i];
    if (touch.obstacle == VertexTouch::kHeld) return false;
    if (touch.obstacle == VertexTouch::kNone) {
      const Vec3 there = body.x[i] + wanted_[i] * h;
      double deepest = -body.near;
      Vec3 out;
      for (std::size_t o = 0; o < body.obstacles.size(); ++o) {
        const auto [distance, normal] = body.obstacles.side(o, there);
        if (distance < deepest) deepest = distance, out = normal, touch.obstacle = static_cast<std::int32_t>(o);
      }
      if (touch.obstacle == VertexTouch::kNone) return false;
      // Sticks if friction could stop it in isolation: a fast vertex must not be stopped to determine its load. A
      // vertex that began inside may be on its way out.
      const double into = -dot(out, wanted_[i]), pressed = std::max(0.0, into);
      const Vec3 along = wanted_[i] + out * into;
      const double speed = norm(along);
      const double friction = body.obstacles.friction(static_cast<std::size_t>(touch.obstacle));
      if (friction > 0 && speed > friction * pressed) touch.sliding = true, touch.drag = along / -speed;
      return true;
    }
    const Vec3 push = reaction_[i] - right_[i], normal = constraints_[i].normal;
    const double friction = body.obstacles.friction(static_cast<std::size_t>(touch.obstacle));
    const double load = dot(push, normal);
    if (load < 0) {
      touch = {};
      return true;
    }
    if (!(friction > 0)) return false;
    if (touch.sliding) {
      if (dot(wanted_[i], touch.drag) > 0 && !touch.settled) {  // friction would accelerate it
        touch.sliding = false, touch.settled = true;
        return true;
      }
      const bool same = std::abs(load - touch.load) <= kSameLoad * load;
      touch.load = load;
      return !same;
    }
    touch.load = load;
    const Vec3 along = push - normal * load;
    const double needed = norm(along);
    if (needed <= friction * load || touch.settled) return false;
    touch.sliding = true, touch.drag = along / needed;
    return true;
  };
  return parallel_reduce(
      body.size(), kImplicitRows, false,
      [&](std::size_t first, std::size_t last) {
        bool changed = false;
        for (std::size_t i = first; i < last; ++i) changed |= revise(i);
        return changed;
      },
      [](bool a, bool b) { return a || b; });
}

void ImplicitStepper::take_over(BodyState& body, double h, std::span<const Vec3> held, StepReport& report) {
  struct Found {
    int contacts = 0;
    bool sane = true;
  };
  const double most = body.longest / h;
  const Found found = parallel_reduce(
      body.size(), kImplicitRows, Found{},
      [&](std::size_t first, std::size_t last) {
        Found result;
        for (std::size_t i = first; i < last; ++i) {
          result.sane &= squared_norm(wanted_[i]) <= most * most;
          body.x[i] += wanted_[i] * h;
          body.v[i] = wanted_[i];
          if (body.obstacles.empty() || touches_[i].obstacle == VertexTouch::kHeld) continue;
          if (body.obstacles.push_out(body.x[i], body.v[i], body.near, 0)) ++result.contacts;
          VertexTouch& touch = touches_[i];
          if (!touch.sliding || touch.obstacle < 0) continue;
          const Vec3 along = constraints_[i].filter(body.v[i]);
          if (const double speed = norm(along); speed > 0) touch.drag = along / -speed;
        }
        return result;
      },
      [](const Found& a, const Found& b) {
        return Found{a.contacts + b.contacts, a.sane && b.sane};
      });
  for (std::size_t k = 0; k < held.size(); ++k) body.x[body.drive.held()[k]] = held[k];
  body.time += h;
  report.contacts = found.contacts;
  if (!found.sane) body.explode(body.x);
}

bool ImplicitStepper::part(BodyState& body, double h, StepReport& report) {
  const auto held = body.drive.held_positions(body.time + h);
  set_up(body, h, held);
  touches_before_ = touches_;
  // The step is driven by the first residual, the right-hand side for Δv, or by external forces if these balance
  // others. The speed of the body does not count: a small force also acts on a fast body.
  double drive = 0, least = 0;
  for (int pass = 1;; ++pass) {
    constrain(body, h);
    if (pass == 1) {
      const auto size = [&](std::span<const Vec3> of) { return solver_.squared_size(constraints_, of); };
      drive = size(external_);
      least = kRounding * kRounding * std::max({size(momentum_), size(base_), drive});
    }
    const SolverReport solved =
        solver_.solve(constraints_, right_, drive, least, body.options.tolerance, body.options.iterations, wanted_);
    if (!solved.finite) body.explode(body.x);
    drive = std::max(drive, solved.first);
    report.solves += 1, report.iterations += solved.iterations;
    if (!solved.converged) {
      touches_ = touches_before_;
      return false;
    }
    const bool settled = body.obstacles.empty() || !revise_contacts(body, h);
    if (settled && held.empty() && falls()) keep_momentum();
    if (settled) break;
    if (pass == kContactPasses) {
      report.unsettled += 1;
      break;
    }
  }
  take_over(body, h, held, report);
  return true;
}

void ImplicitStepper::step(BodyState& body, double h, StepReport& report) {
  // Counts in units of the shortest substep, so that substeps end exactly with the step.
  const long whole = 1L << body.options.halvings;
  for (long done = 0; done < whole;) {
    const long size = whole >> level_;
    const double length = h * static_cast<double>(size) / static_cast<double>(whole);
    if (!part(body, length, report)) {
      ++report.halvings, calm_ = 0;
      if (level_ == body.options.halvings) {
        throw DataError("conjugate gradients do not converge in " + std::to_string(body.options.iterations) +
                        " iterations for any step: allow more `iterations`, a larger `tolerance` or more "
                        "`halvings`");
      }
      ++level_;
      continue;
    }
    done += size;
    report.parts += 1;
    report.shortest = report.shortest > 0 ? std::min(report.shortest, length) : length;
    if (++calm_ >= kCalmParts && level_ > 0 && done % (2 * size) == 0) --level_, calm_ = 0;
  }
  report.time = body.time;
}

constexpr BodyIntegrator kImplicit[] = {
    {.name = "implicit-euler",
     .summary = "Baraff and Witkin's method, for stiff bodies and long steps",
     .make = []() -> std::unique_ptr<BodyStepper> { return std::make_unique<ImplicitStepper>(); },
     .is_implicit = true}};

}  // namespace

std::span<const BodyIntegrator> implicit_step_integrators() { return kImplicit; }

}  // namespace sansmesh::inline v1
