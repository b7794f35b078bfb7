// Median of a list.
#pragma once

#include <algorithm>
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

}  // namespace sansmesh::inline v1
