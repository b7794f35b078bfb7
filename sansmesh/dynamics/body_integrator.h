// Time integrators of bodies: steps, stability limits and registry.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "sansmesh/schema/registry.h"
#include "sansmesh/simulate_options.h"

namespace sansmesh::inline v1 {

struct BodyState;

/// Bounds of the body's vibrations about rest: every motion has a frequency and a decay within these.
struct VibrationBounds {
  double frequency = 0;       ///< ω², 1/s², of the fastest vibration, springs of handles included
  double handles = 0;         ///< largest of the handles' springs alone: stiffness over mass, 1/s²
  double decay = 0;           ///< largest c of ẍ = −ω² x − c ẋ, 1/s
  double uniform_decay = 0;   ///< part of c that all motions share, 1/s
  double relative_decay = 0;  ///< c is at least this many seconds times ω² of the body itself
};

/// Advances one body step by step.
class BodyStepper {
 public:
  virtual ~BodyStepper() = default;
  /// Advances positions, velocities and time by h seconds, and adds the effort to the report. Throws DataError if the
  /// body explodes, or no step is short enough.
  virtual void step(BodyState& body, double h, StepReport& report) = 0;
  /// Called when the body's state was changed from outside.
  virtual void reset() {}
};

/// A time integrator. Registered once, in its own source; library, command line, scenes and help use the registry.
struct BodyIntegrator {
  std::string_view name;     ///< name for users: "velocity-verlet"
  std::string_view summary;  ///< short description
  std::unique_ptr<BodyStepper> (*make)() = nullptr;
  /// The longest step, s, that is stable for all motions within bounds that are not all 0; 0 if none is. Null:
  /// unconditionally stable.
  double (*stable_step)(const VibrationBounds& bounds) = nullptr;
  bool is_implicit = false;  ///< steps solve systems; `tolerance`, `iterations` and `halvings` apply

  /// Integrators of the library in the order of sansmesh/dynamics/CMakeLists.txt, followed by registered ones.
  static Registry<BodyIntegrator>& registry();
};

/// Looks up an integrator. Throws ArgumentError naming the choices.
inline const BodyIntegrator& body_integrator(std::string_view name) { return BodyIntegrator::registry().at(name); }

/// Integrators of each source, in the order of CMakeLists.txt, which generates the definition.
std::vector<std::span<const BodyIntegrator>> own_body_integrators();

/// The longest step, s, with which an integrator is stable for all motions within these bounds: infinity if any is; for
/// explicit Euler 0 without damping, or if undamped springs hold handles.
double stable_step(const BodyIntegrator& integrator, const VibrationBounds& bounds);

}  // namespace sansmesh::inline v1
