// Integrators of particles: batched steps and registry.
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

/// A step of a batch of particles. The integrator queries the flow along their paths stage by stage, for all particles
/// at once.
class ParticleStep {
 public:
  explicit ParticleStep(const VectorField& field) : field_(field) {}

  // For integrators.

  std::size_t size() const { return starts_.size(); }
  double duration(std::size_t i) const { return durations_[i]; }  ///< time of the step, negative against the flow
  /// Velocities of a stage: of stage 0 at the start, of stage k from the k-th ask(). They stay valid until the step is
  /// complete.
  std::span<const Vec3> velocities(std::size_t stage) const { return velocities_[stage]; }

  /// Queries the flow at start + mean(i) · duration, where mean(i) is a velocity, at the moment after `share` of the
  /// duration. The last query, after the whole duration, is the end of the step. Particles that have left the flow are
  /// NaN from then on.
  template <class Mean>
  void ask(double share, const Mean& mean) {
    for (std::size_t i = 0; i < size(); ++i) {
      places_[i] = starts_[i] + mean(i) * durations_[i];
      moments_[i] = times_[i] + share * durations_[i];
    }
    ask_field();
  }

  /// For adaptive integrators: error of the end (length).
  double& error(std::size_t i) { return errors_[i]; }
  /// For integrators with dense output: the term of fourth degree (length) beyond both ends and their velocities, as
  /// hairer1993 writes it for Dormand and Prince's method; zero by default.
  Vec3& bulge(std::size_t i) { return bulges_[i]; }

  // For callers of steps.

  /// Starts a step of this many particles, which put() describes.
  void begin(std::size_t particles);
  void put(std::size_t i, const Vec3& start, double time, double duration, const Vec3& velocity) {
    starts_[i] = start, times_[i] = time, durations_[i] = duration, velocities_[0][i] = velocity;
  }
  bool has_left(std::size_t i) const { return out_[i] != 0; }  ///< left the flow during the step
  const Vec3& end(std::size_t i) const { return places_[i]; }
  const Vec3& last_velocity(std::size_t i) const { return velocities_[stages_ - 1][i]; }

 private:
  void ask_field();

  const VectorField& field_;
  std::vector<Vec3> starts_, places_, bulges_;
  std::vector<double> times_, durations_, moments_, errors_;
  /// Velocities of each stage; sized for the largest number of stages so far.
  std::vector<std::vector<Vec3>> velocities_;
  std::size_t stages_ = 0;  ///< stages of the current step
  std::vector<std::uint8_t> inside_, out_;
};

/// An integrator. Registered once, in its own source; library, command line and help use the registry.
struct FlowIntegrator {
  std::string_view name;     ///< name for users: "rk4"
  std::string_view summary;  ///< short description: "fourth order"
  void (*step)(ParticleStep& step) = nullptr;
  int order = 1;  ///< order of the global error in the step length
  /// Adaptive step length: the integrator estimates errors, which fall with that order.
  bool adaptive = false;
  /// Default of TraceOptions::step as a fraction of the diagonal of the field's bounds: the step length, or its upper
  /// limit for adaptive integrators.
  double reach = 1e-3;

  /// Integrators of the library in the order of sansmesh/flow/CMakeLists.txt, followed by registered ones.
  static Registry<FlowIntegrator>& registry();
};

/// Integrators of each source, in the order of CMakeLists.txt, which generates the definition.
std::vector<std::span<const FlowIntegrator>> own_flow_integrators();

}  // namespace sansmesh::inline v1
