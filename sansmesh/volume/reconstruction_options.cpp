#include "sansmesh/volume/reconstruction_options.h"

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/error.h"

namespace sansmesh {

void ReconstructionOptions::validate() const {
  if (degree) check_range("degree", *degree, 0, 5);
  if (iterations) check_range("iterations", *iterations, 0, 100);
  if (shape) check_range("shape", *shape, 0.05, 10.0);
  if (order && *order != 2 && *order != 4 && *order != 6) throw ArgumentError("`order` must be 2, 4 or 6");
  if (radius) check_range("radius", *radius, 1.0, 10.0);
  check_range("b", b, 0.0, 1.0);
  check_range("c", c, 0.0, 1.0);
}

}  // namespace sansmesh
