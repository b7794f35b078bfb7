#include "sansmesh/dynamics/body_integrator.h"

#include <limits>

namespace sansmesh::inline v1 {

Registry<BodyIntegrator>& BodyIntegrator::registry() {
  static Registry<BodyIntegrator> integrators("integrator of bodies", own_body_integrators());
  return integrators;
}

double stable_step(const BodyIntegrator& integrator, const VibrationBounds& bounds) {
  const bool moves = bounds.frequency > 0 || bounds.decay > 0;
  return integrator.stable_step && moves ? integrator.stable_step(bounds) : std::numeric_limits<double>::infinity();
}

}  // namespace sansmesh::inline v1
