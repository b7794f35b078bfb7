// Explicit integrators: Euler, Verlet, velocity Verlet. On an eigenvector of a method's step the matrices M, K and D
// are numbers: a step that is stable for ẍ = −ω² x − c ẋ, for all ω² and c within the bounds, is stable for the body.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/dynamics/explicit_step.h"

namespace sansmesh::inline v1 {
namespace {

class EulerStepper : public ExplicitStepper {
 public:
  EulerStepper() : ExplicitStepper(true) {}

 private:
  void move(BodyState& body, double h) override {
    force_.resize(body.size());
    body.forces(body.x, body.v, body.time, force_);
    parallel_for(0, body.size(), kExplicitRows, [&](std::size_t i) {
      body.x[i] += body.v[i] * h;
      body.v[i] += force_[i] * (h / body.masses[i]);
    });
  }

  std::vector<Vec3> force_;
};

/// 1 + h λ in the unit circle, λ² + c λ + ω² = 0: h <= c / ω² for oscillations, 2 / |λ| for overdamped motions.
double stable_for_euler(const VibrationBounds& bounds) {
  const double w = bounds.frequency, c = bounds.decay, alpha = bounds.uniform_decay;
  const double whole = alpha + bounds.relative_decay * w;
  double least = w > 0 ? whole / (w + bounds.handles) : std::numeric_limits<double>::infinity();
  if (bounds.handles > 0) least = std::min(least, alpha / bounds.handles);
  return c > 0 ? std::min(least, 2 / c) : least;
}

/// x(t + h) = 2 x(t) − x(t − h) + h² a(t) with v = (x(t) − x(t − h)) / h, the velocity half a step earlier.
class VerletStepper : public ExplicitStepper {
 public:
  VerletStepper() : ExplicitStepper(false) {}

 private:
  void move(BodyState& body, double h) override {
    force_.resize(body.size());
    body.forces(body.x, body.v, body.time, force_);
    // First step, or changed step length: half of the previous step is missing.
    const double gained = 0.5 * h + body.lag;
    parallel_for(0, body.size(), kExplicitRows, [&](std::size_t i) {
      body.v[i] += force_[i] * (gained / body.masses[i]);
      body.x[i] += body.v[i] * h;
    });
    body.lag = 0.5 * h;
  }

  std::vector<Vec3> force_;
};

/// z² − (2 − c h − ω² h²) z + 1 − c h: ω² h² + 2 c h <= 4.
double stable_for_verlet(const VibrationBounds& bounds) {
  const double w = bounds.frequency, c = bounds.decay;
  return 4 / (c + std::sqrt(c * c + 4 * w));
}

class VelocityVerletStepper : public ExplicitStepper {
 public:
  VelocityVerletStepper() : ExplicitStepper(false) {}
  void reset() override { known_ = false; }

 private:
  void move(BodyState& body, double h) override {
    force_.resize(body.size()), guess_.resize(body.size());
    if (!known_) body.forces(body.x, body.v, body.time, force_);
    parallel_for(0, body.size(), kExplicitRows, [&](std::size_t i) {
      const Vec3 gain = force_[i] * (0.5 * h / body.masses[i]);
      body.v[i] += gain;
      body.x[i] += body.v[i] * h;
      guess_[i] = body.v[i] + gain;  // at the end, for damping
    });
  }

  void arrive(BodyState& body, double h) override {
    for (const std::uint32_t i : body.drive.held()) guess_[i] = body.v[i];
    body.forces(body.x, guess_, body.time, force_);
    parallel_for(0, body.size(), kExplicitRows, [&](std::size_t i) {
      body.v[i] += force_[i] * (0.5 * h / body.masses[i]);
      if (!body.obstacles.empty() && !body.is_held[i]) body.obstacles.push_out(body.x[i], body.v[i], body.near, 0);
    });
    known_ = true;
  }

  std::vector<Vec3> force_, guess_;
  bool known_ = false;  ///< force_ is valid for the body's positions
};

/// z³ + (ω² h² + 3/2 c h − 2) z² + (1 − 2 c h) z + 1/2 c h: ω² h² + 4 c h <= 4.
double stable_for_velocity_verlet(const VibrationBounds& bounds) {
  const double w = bounds.frequency, c = bounds.decay;
  return 2 / (c + std::sqrt(c * c + w));
}

template <class Stepper>
std::unique_ptr<BodyStepper> make_stepper() {
  return std::make_unique<Stepper>();
}

constexpr BodyIntegrator kExplicit[] = {
    {.name = "explicit-euler",
     .summary = "explicit Euler method, first order",
     .make = make_stepper<EulerStepper>,
     .stable_step = stable_for_euler},
    {.name = "verlet",
     .summary = "Störmer's method on positions; damping uses the velocity half a step earlier",
     .make = make_stepper<VerletStepper>,
     .stable_step = stable_for_verlet},
    {.name = "velocity-verlet",
     .summary = "damping uses the velocity of the same moment",
     .make = make_stepper<VelocityVerletStepper>,
     .stable_step = stable_for_velocity_verlet}};

}  // namespace

std::span<const BodyIntegrator> explicit_steps_integrators() { return kExplicit; }

}  // namespace sansmesh::inline v1
