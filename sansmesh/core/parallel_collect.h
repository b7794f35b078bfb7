// Parallel search with results in index order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {

/// Calls collect(first, last, found) on chunks of exactly `chunk` indices of [0, n) (the last may be shorter) and
/// concatenates the lists `found` in chunk order.
template <class T, class Collect>
std::vector<T> parallel_collect(std::size_t n, std::size_t chunk, const Collect& collect) {
  std::vector<std::vector<T>> parts((n + chunk - 1) / chunk);
  parallel_for(0, parts.size(), 1, [&](std::size_t c) { collect(c * chunk, std::min(n, (c + 1) * chunk), parts[c]); });
  std::size_t size = 0;
  for (const std::vector<T>& part : parts) size += part.size();
  std::vector<T> all;
  all.reserve(size);
  for (std::vector<T>& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
    part = {};
  }
  return all;
}

}  // namespace sansmesh::inline v1
