#include "sansmesh/mesh/edit/collapse_options.h"

#include <cmath>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

void CollapseOptions::validate() const {
  if (!(std::isfinite(error) && (error > 0 || triangles > 0)))
    throw ArgumentError("simplify: `error` must be a positive length");
  if (!(least_gain >= 0 && least_gain <= 1)) throw ArgumentError("simplify: `least_gain` must lie in 0..1");
  if (!(least_shape >= 0 && least_shape <= 0.9)) throw ArgumentError("simplify: `least_shape` must lie in 0..0.9");
}

}  // namespace sansmesh::inline v1
