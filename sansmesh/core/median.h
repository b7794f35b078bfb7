// Robust statistics: median, and weights that reject outliers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace sansmesh::inline v1 {

/// The n-th smallest of the values, which are reordered; n counts from 0.
template <class T>
T nth_smallest(std::span<T> values, std::size_t n) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(n);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}
template <class T>
T nth_smallest(std::vector<T>& values, std::size_t n) {
  return nth_smallest(std::span<T>(values), n);
}

/// Upper median of the values, which are reordered; 0 for an empty list.
template <class T>
T median(std::span<T> values) {
  return values.empty() ? T(0) : nth_smallest(values, values.size() / 2);
}
template <class T>
T median(std::vector<T>& values) {
  return median(std::span<T>(values));
}

/// The value that a share of the values, which are reordered, is below; rounded down; 0 for an empty list.
template <class T>
T quantile(std::vector<T>& values, double share) {
  if (values.empty()) return T(0);
  return nth_smallest(values, static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

/// Standard deviation of normal deviates over the median of their magnitudes.
inline constexpr double kDeviationOverMedian = 1.4826;

/// Tukey's biweight of a deviation relative to its largest accepted one: 1 at 0, 0 from 1 on.
inline double tukey_weight(double t) { return std::abs(t) < 1 ? (1 - t * t) * (1 - t * t) : 0; }

}  // namespace sansmesh::inline v1
