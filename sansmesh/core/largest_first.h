// Order of values by descending size.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace sansmesh::inline v1 {

/// Indices of the values in descending order; equal values keep their order.
template <class T>
std::vector<std::uint32_t> largest_first(const std::vector<T>& values) {
  std::vector<std::uint32_t> order(values.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return values[a] > values[b]; });
  return order;
}

/// Renumbers groups by descending size: `of` are numbers of groups, `size` their sizes.
template <class T>
void number_largest_first(std::vector<std::uint32_t>& of, std::vector<T>& size) {
  const std::vector<std::uint32_t> order = largest_first(size);
  std::vector<std::uint32_t> rank(order.size());
  std::vector<T> sorted(order.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) rank[order[k]] = k, sorted[k] = size[order[k]];
  size = std::move(sorted);
  for (std::uint32_t& group : of) group = rank[group];
}

}  // namespace sansmesh::inline v1
