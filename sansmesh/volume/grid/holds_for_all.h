// Parallel predicate over long arrays.
#pragma once

#include <atomic>
#include <cstddef>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1::detail {

/// Whether right(i) holds for all i < n. Runs in parallel.
template <class Right>
bool holds_for_all(std::size_t n, const Right& right) {
  std::atomic<bool> all = true;
  parallel_ranges(0, n, 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!right(i)) return all.store(false);
  });
  return all;
}

}  // namespace sansmesh::inline v1::detail
