#include "sansmesh/flow/flow_surface_options.h"

#include <cmath>

#include "sansmesh/core/error.h"

namespace sansmesh {
namespace {

void require(bool ok, const char* what) {
  if (!ok) throw ArgumentError(what);
}

}  // namespace

void FlowSurfaceOptions::validate() const {
  trace.validate();
  const bool released = kind == FlowSurfaceKind::streak || kind == FlowSurfaceKind::time;
  require(seeds >= 2, "`seeds` must be at least 2");
  require(std::isfinite(alpha) && alpha > 1, "`alpha` must be above 1");
  require(std::isfinite(beta) && beta > 0, "`beta` must be positive");
  require(delta >= 0 && delta < 1 && 2 * delta <= alpha,
          "`delta` must be at least 0, below 1 and at most half `alpha`");
  require(!start || std::isfinite(*start), "`start` must be finite");
  require(duration > 0, "`duration` must be positive");
  require(!front_step || (std::isfinite(*front_step) && *front_step > 0), "`front_step` must be a positive time");
  require(most_fronts >= 1, "`most_fronts` must be at least 1");
  require(most_points >= 2, "`most_points` must be at least 2");
  require(!released || direction != FlowDirection::both, "`direction = both` is for stream and path surfaces");
  require(kind != FlowSurfaceKind::time || (is_finite(sweep) && norm(sweep) > 0),
          "`sweep` of a time surface must have a length");
}

}  // namespace sansmesh
