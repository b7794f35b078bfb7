// Integrators of particles by name: how a step of many is made, and the registry of all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "sansmesh/schema/registry.h"
#include "sansmesh/vec.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1 {

/// A step of particles that go together, an entry each. Whoever makes it asks for the flow on their ways, stage by
/// stage, all particles at once.
class ParticleStep {
 public:
  explicit ParticleStep(const VectorField& field) : field_(field) {}

  // For integrators.

  std::size_t size() const { return starts_.size(); }
  double duration(std::size_t i) const { return durations_[i]; }  ///< time of the step, negative against the flow
  /// Those of a stage: of 0 where particles start, of k what the k-th ask() found. They stay where they are until the
  /// step is made.
  std::span<const Vec3> velocities(std::size_t stage) const { return velocities_[stage]; }

  /// Asks where particles are that move by mean(i) for their whole durations, a velocity, at the moment after `share`
  /// of these. The last that is asked for, after all of it, is where the step ends. Particles that have left the flow
  /// are nowhere from then on: they are NaN.
  template <class Mean>
  void ask(double share, const Mean& mean) {
    for (std::size_t i = 0; i < size(); ++i) {
      places_[i] = starts_[i] + mean(i) * durations_[i];
      moments_[i] = times_[i] + share * durations_[i];
    }
    ask_field();
  }

  /// Of integrators whose steps follow the tolerance: by how much its end may be off (length).
  double& error(std::size_t i) { return errors_[i]; }
  /// Of those that know more of the way than both ends and the velocities there: what the term of fourth degree adds
  /// (length), as Hairer, Nørsett & Wanner write it for Dormand and Prince's; zero by itself.
  Vec3& bulge(std::size_t i) { return bulges_[i]; }

  // For those who ask for steps.

  /// A step of so many, which put() describes.
  void begin(std::size_t particles);
  void put(std::size_t i, const Vec3& start, double time, double duration, const Vec3& velocity) {
    starts_[i] = start, times_[i] = time, durations_[i] = duration, velocities_[0][i] = velocity;
  }
  bool has_left(std::size_t i) const { return out_[i] != 0; }  ///< the flow, on its way
  const Vec3& end(std::size_t i) const { return places_[i]; }
  const Vec3& last_velocity(std::size_t i) const { return velocities_[stages_ - 1][i]; }

 private:
  void ask_field();

  const VectorField& field_;
  std::vector<Vec3> starts_, places_, bulges_;
  std::vector<double> times_, durations_, moments_, errors_;
  std::vector<std::vector<Vec3>> velocities_;  ///< as many as any step had stages
  std::size_t stages_ = 0;                     ///< of this one
  std::vector<std::uint8_t> inside_, out_;
};

/// One way to follow particles. Registered once, in its own source: library, command line and help know it from there.
struct FlowIntegrator {
  std::string_view name;     ///< as users write it: "rk4"
  std::string_view summary;  ///< a few words: "fourth order"
  void (*step)(ParticleStep& step) = nullptr;
  int order = 1;  ///< the error at a moment falls as this power of the steps' length
  /// Steps follow the tolerance: it tells their errors, which fall as that power of the length.
  bool adaptive = false;
  /// Default of TraceOptions::step, of the diagonal of the field's bounds: how far a step goes, at most where steps
  /// follow the tolerance.
  double reach = 1e-3;

  /// Those of the library in the order of sansmesh/flow/CMakeLists.txt, then those that programs add.
  static Registry<FlowIntegrator>& registry();
};

/// Those of each source that has some, in the order of CMakeLists.txt, from which the definition is made.
std::vector<std::span<const FlowIntegrator>> own_flow_integrators();

}  // namespace sansmesh::inline v1
