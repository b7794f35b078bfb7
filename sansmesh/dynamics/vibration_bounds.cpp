#include "sansmesh/dynamics/vibration_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sansmesh::inline v1 {

// An eigenvector of a method's step turns the matrices M, K and D into numbers: what holds for ẍ = −ω² x − c ẋ with all
// ω² and c in the bounds holds for the body.
double stable_step(DynamicsIntegrator integrator, const VibrationBounds& bounds) {
  const double w = bounds.frequency, c = bounds.decay;
  constexpr double kAny = std::numeric_limits<double>::infinity();
  if (integrator == DynamicsIntegrator::implicit_euler || !(w > 0 || c > 0)) return kAny;
  switch (integrator) {
    case DynamicsIntegrator::explicit_euler: {
      // 1 + h λ in the unit circle, λ² + c λ + ω² = 0: h <= c / ω² of what vibrates, 2 / |λ| of what creeps.
      const double alpha = bounds.uniform_decay, whole = alpha + bounds.relative_decay * w;
      double least = w > 0 ? whole / (w + bounds.handles) : kAny;
      if (bounds.handles > 0) least = std::min(least, alpha / bounds.handles);
      return c > 0 ? std::min(least, 2 / c) : least;
    }
    case DynamicsIntegrator::verlet:
      // z² − (2 − c h − ω² h²) z + 1 − c h: ω² h² + 2 c h <= 4.
      return 4 / (c + std::sqrt(c * c + 4 * w));
    default:
      // Velocity Verlet: z³ + (ω² h² + 3/2 c h − 2) z² + (1 − 2 c h) z + 1/2 c h: ω² h² + 4 c h <= 4.
      return 2 / (c + std::sqrt(c * c + w));
  }
}

}  // namespace sansmesh::inline v1
