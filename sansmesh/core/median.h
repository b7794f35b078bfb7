// Robust statistics: median, and weights that reject outliers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace sansmesh::inline v1 {

/// Upper median of the values, which are reordered; 0 for an empty list.
template <class T>
T median(std::vector<T>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Standard deviation of normal deviates over the median of their magnitudes.
inline constexpr double kDeviationOverMedian = 1.4826;

/// Tukey's biweight of a deviation relative to its largest accepted one: 1 at 0, 0 from 1 on.
inline double tukey_weight(double t) { return std::abs(t) < 1 ? (1 - t * t) * (1 - t * t) : 0; }

}  // namespace sansmesh::inline v1
