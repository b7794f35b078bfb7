#include "sansmesh/core/binary_scale.h"

#include <algorithm>

namespace sansmesh::inline v1 {

double binary_scale(double largest) {
  constexpr double kModerate = 0x1p50;
  constexpr int kMost = 1000;
  if (!(largest > 0) || !std::isfinite(largest) || (largest <= kModerate && largest >= 1 / kModerate)) return 1;
  return std::ldexp(1.0, std::clamp(-std::ilogb(largest), -kMost, kMost));
}

double detail::scaled_norm(const Vec3& v) {
  const double scale = binary_scale(std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}));
  return norm(v * scale) / scale;
}

double vector_length(std::span<const double> v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  if (sum >= 0x1p-900 && sum <= 0x1p900) return std::sqrt(sum);
  double largest = 0;
  for (const double x : v) largest = std::max(largest, std::abs(x));
  const double scale = binary_scale(largest);
  sum = 0;
  for (const double x : v) sum += (x * scale) * (x * scale);
  return std::sqrt(sum) / scale;
}

}  // namespace sansmesh::inline v1
