#include "sansmesh/surface/curvature_options.h"

#include <cmath>
#include <numbers>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/error.h"

namespace sansmesh {

float curvedness(const PrincipalCurvatures& c) { return std::sqrt(0.5f * (c.k1 * c.k1 + c.k2 * c.k2)); }

float shape_index(const PrincipalCurvatures& c) {
  return c.k1 == 0 && c.k2 == 0 ? 0 : 2 * std::numbers::inv_pi_v<float> * std::atan2(c.k1 + c.k2, c.k1 - c.k2);
}

void CurvatureOptions::validate() const {
  check_range("tau", tau, 1, 4);
  if (radius && !(*radius > 0 && std::isfinite(*radius))) throw ArgumentError("`radius` must be positive");
  if (neighbours) check_range("neighbours", *neighbours, 8, 2000);
  if (noise && !(*noise >= 0 && std::isfinite(*noise))) throw ArgumentError("`noise` must not be negative");
}

}  // namespace sansmesh
