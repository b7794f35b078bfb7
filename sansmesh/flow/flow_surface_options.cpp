#include "sansmesh/flow/flow_surface_options.h"

#include <cmath>

#include "sansmesh/core/check_range.h"

namespace sansmesh {

void FlowSurfaceOptions::validate() const {
  trace.validate();
  const bool released = kind == FlowSurfaceKind::streak || kind == FlowSurfaceKind::time;
  check_argument(seeds >= 2, "`seeds` must be at least 2");
  check_argument(std::isfinite(alpha) && alpha > 1, "`alpha` must be above 1");
  check_argument(std::isfinite(beta) && beta > 0, "`beta` must be positive");
  check_argument(delta >= 0 && delta < 1 && 2 * delta <= alpha,
                 "`delta` must be at least 0, below 1 and at most half `alpha`");
  check_argument(!start || std::isfinite(*start), "`start` must be finite");
  check_argument(duration > 0, "`duration` must be positive");
  check_argument(!length || *length > 0, "`length` must be positive");
  check_argument(!length || !released, "`length` is for stream and path surfaces");
  check_argument(!front_step || (std::isfinite(*front_step) && *front_step > 0),
                 "`front_step` must be a positive time");
  check_argument(most_fronts >= 1, "`most_fronts` must be at least 1");
  check_argument(most_points >= 2, "`most_points` must be at least 2");
  check_argument(!released || direction != FlowDirection::both, "`direction = both` is for stream and path surfaces");
  check_argument(kind != FlowSurfaceKind::time || (is_finite(sweep) && norm(sweep) > 0),
                 "`sweep` of a time surface must have a length");
}

}  // namespace sansmesh
