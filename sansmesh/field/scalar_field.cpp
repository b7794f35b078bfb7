#include "sansmesh/scalar_field.h"

#include <vector>

namespace sansmesh::inline v1 {

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

void detail::fill_undefined(const ScalarField& other, std::span<const Vec3> x, std::span<const std::uint8_t> inside,
                            std::span<double> values, std::span<Vec3> gradients) {
  std::vector<Vec3> undefined;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (inside[i] == 0) undefined.push_back(x[i]);
  if (undefined.empty()) return;
  std::vector<double> found(undefined.size());
  std::vector<Vec3> slopes(gradients.empty() ? 0 : undefined.size());
  other.evaluate(undefined, found, slopes);
  for (std::size_t i = 0, k = 0; i < x.size(); ++i) {
    if (inside[i] != 0) continue;
    values[i] = found[k];
    if (!gradients.empty()) gradients[i] = slopes[k];
    ++k;
  }
}

}  // namespace sansmesh::inline v1
