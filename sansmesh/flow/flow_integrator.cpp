#include "sansmesh/flow/flow_integrator.h"

#include <limits>

namespace sansmesh::inline v1 {

void ParticleStep::begin(std::size_t particles) {
  for (auto* const list : {&starts_, &places_}) list->resize(particles);
  for (auto* const list : {&times_, &durations_, &moments_}) list->resize(particles);
  bulges_.assign(particles, {}), errors_.assign(particles, 0);
  inside_.resize(particles), out_.assign(particles, 0);
  if (velocities_.empty()) velocities_.emplace_back();
  velocities_[0].resize(particles);
  stages_ = 1;
}

/// Evaluates the field at places_ and moments_. Particles that have left the field in this step are skipped: searching
/// for them would cost more than all others.
void ParticleStep::ask_field() {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < places_.size(); ++i)
    if (out_[i] != 0) places_[i] = {kNaN, kNaN, kNaN};
  if (velocities_.size() == stages_) velocities_.emplace_back();
  std::vector<Vec3>& found = velocities_[stages_++];
  found.resize(places_.size());
  field_.evaluate(places_, moments_, found, inside_);
  for (std::size_t i = 0; i < inside_.size(); ++i) out_[i] = out_[i] != 0 || inside_[i] == 0;
}

Registry<FlowIntegrator>& FlowIntegrator::registry() {
  static Registry<FlowIntegrator> integrators("integrator of flows", own_flow_integrators());
  return integrators;
}

}  // namespace sansmesh::inline v1
