#include "sansmesh/field/scalar_field.h"

#include <vector>

namespace sansmesh {

void ScalarField::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  detail::ranges_by_slope(*this, kAssumedSlope, x, radius, found);
}

void detail::ranges_by_slope(const ScalarField& field, double slope, std::span<const Vec3> x, double radius,
                             std::span<ValueRange> found) {
  std::vector<double> values(x.size());
  field.evaluate(x, values);
  const double change = slope * radius;
  for (std::size_t i = 0; i < x.size(); ++i) found[i] = {values[i] - change, values[i] + change};
}

}  // namespace sansmesh
