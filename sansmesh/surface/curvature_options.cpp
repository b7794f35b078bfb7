#include "sansmesh/surface_options.h"

#include <cmath>
#include <numbers>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

float curvedness(const PrincipalCurvatures& c) { return std::sqrt(0.5f * (c.k1 * c.k1 + c.k2 * c.k2)); }

float shape_index(const PrincipalCurvatures& c) {
  return c.k1 == 0 && c.k2 == 0 ? 0 : 2 * std::numbers::inv_pi_v<float> * std::atan2(c.k1 + c.k2, c.k1 - c.k2);
}

const OptionSchema& CurvatureOptions::schema() {
  using O = CurvatureOptions;
  static constexpr std::string_view weights[] = {"m-like", "gaussian", "uniform"};
  static constexpr OptionRow rows[] = {
      option<&O::neighbours>(
          {.text = "Samples in a neighbourhood", .from_data = "from noise and shape", .range = {8, 2000}}),
      option<&O::bandwidth>({.text = "Width of the weights as one length, in place of `neighbours`",
                             .unit = "length",
                             .range = positive(),
                             .old_name = "radius"}),
      option<&O::tau>({.text = "Exponent of the M-like weights", .unit = "exponent", .range = {1, 4}}),
      option<&O::weights>({.text = "m-like, gaussian or uniform", .unit = "choice", .choices = weights})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void CurvatureOptions::validate() const {
  validate_options(*this);
  if (noise && !(*noise >= 0 && std::isfinite(*noise))) throw ArgumentError("`noise` must not be negative");
}

}  // namespace sansmesh::inline v1
