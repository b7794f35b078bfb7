#include "sansmesh/deform/deformation_options.h"

#include "sansmesh/core/check_range.h"

namespace sansmesh {

void MlsDeformationOptions::validate() const {
  check_argument(degree == 2 || degree == 3, "`degree` must be 2 or 3");
  check_range("alpha", alpha, 0.5, 8);
  check_range("damping", damping, 1, 1e6);
}

}  // namespace sansmesh
