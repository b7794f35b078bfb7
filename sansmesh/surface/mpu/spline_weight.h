// Weights of multi-level partition of unity implicits.
#pragma once

namespace sansmesh::inline v1 {

/// b(3 r / 2) with the quadratic B-spline b, r the distance from the centre over the radius of the ball (ohtake2003,
/// equation 3): 0.75 at the centre, 0 from the rim on, with a continuous slope.
inline double spline_weight(double r) {
  const double t = 1.5 * r;
  if (t < 0.5) return 0.75 - t * t;
  const double rest = t < 1.5 ? 1.5 - t : 0;
  return 0.5 * rest * rest;
}

/// Derivative of spline_weight with respect to r, over r.
inline double spline_weight_slope(double r) {
  const double t = 1.5 * r;
  if (t < 0.5) return -4.5;
  return t < 1.5 ? -1.5 * (1.5 - t) / r : 0;
}

}  // namespace sansmesh::inline v1
