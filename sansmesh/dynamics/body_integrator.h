// Integrators of bodies in time, by name: the steps that they make, those that are short enough, and the registry of
// all of them.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "sansmesh/schema/registry.h"
#include "sansmesh/simulate_options.h"

namespace sansmesh::inline v1 {

struct BodyState;

/// The body's vibrations at rest, bounded: every motion of it has a frequency and a decay within these.
struct VibrationBounds {
  double frequency = 0;       ///< ω², 1/s², of the fastest, springs of handles included
  double handles = 0;         ///< the largest of these alone, stiffness over mass, 1/s²
  double decay = 0;           ///< c of ẍ = −ω² x − c ẋ, 1/s: the largest
  double uniform_decay = 0;   ///< the part of c that all motions have, 1/s
  double relative_decay = 0;  ///< c is at least so many seconds times the ω² of the body itself
};

/// Makes the steps of one body, one after the other.
class BodyStepper {
 public:
  virtual ~BodyStepper() = default;
  /// Takes positions, velocities and time of the body on by h seconds, and adds to the report what that took. Throws
  /// DataError where the body explodes, or no step is short enough.
  virtual void step(BodyState& body, double h, StepReport& report) = 0;
  /// The body is not where it was left.
  virtual void reset() {}
};

/// One way to integrate bodies. Registered once, in its own source: library, command line, scenes and help know it from
/// there.
struct BodyIntegrator {
  std::string_view name;     ///< as users write it: "velocity-verlet"
  std::string_view summary;  ///< a few words
  std::unique_ptr<BodyStepper> (*make)() = nullptr;
  /// The longest step, s, that is stable for all motions within bounds some of which are not 0; 0 where none is. Null
  /// where any is.
  double (*stable_step)(const VibrationBounds& bounds) = nullptr;
  bool is_implicit = false;  ///< steps solve systems: `tolerance`, `iterations` and `halvings` count

  /// Those of the library in the order of sansmesh/dynamics/CMakeLists.txt, then those that programs add.
  static Registry<BodyIntegrator>& registry();
};

/// By name. Throws ArgumentError naming the choices.
inline const BodyIntegrator& body_integrator(std::string_view name) { return BodyIntegrator::registry().at(name); }

/// Those of each source that has some, in the order of CMakeLists.txt, from which the definition is made.
std::vector<std::span<const BodyIntegrator>> own_body_integrators();

/// The longest step, s, with which an integrator is stable for all motions within these bounds: infinity where any is;
/// of explicit Euler 0 where nothing damps, or handles hang on springs that nothing damps.
double stable_step(const BodyIntegrator& integrator, const VibrationBounds& bounds);

}  // namespace sansmesh::inline v1
