// The value in the middle.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sansmesh::inline v1 {

/// The upper median of the values, which it puts into another order; 0 of none.
template <class T>
T median(std::vector<T>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace sansmesh::inline v1
