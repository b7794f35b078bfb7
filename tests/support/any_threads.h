// Checks that results do not depend on the number of threads.
#pragma once

#include <gtest/gtest.h>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/parallel_backend.h"
#include "support/sanitizers.h"

namespace sansmesh::test {

/// Result of work() with this number of threads, even on fewer cores.
template <class Work>
auto with_threads(int threads, const Work& work) {
  const ThreadScope scope(threads);
  return work();
}

/// Calls compare(one, many) with the results of work() on one thread, and on 2 and 8. The thread sanitizer only needs
/// work() to run on several threads; memory sanitizers check the same code elsewhere.
template <class Work, class Compare>
void compare_threads(const Work& work, const Compare& compare) {
  if constexpr (SANSMESH_WATCHED_THREADS) {
    const auto seen = with_threads(4, work);
    return compare(seen, seen);
  }
  if (kAddressSanitizer) GTEST_SKIP() << "the same code three times";
  const auto one = with_threads(1, work);
  for (const int threads : {2, 8}) {
    SCOPED_TRACE(testing::Message() << threads << " threads");
    compare(one, with_threads(threads, work));
  }
}

/// For results with an equality operator.
template <class Work>
void expect_equal_for_any_threads(const Work& work) {
  compare_threads(work, [](const auto& one, const auto& many) { EXPECT_TRUE(one == many); });
}

}  // namespace sansmesh::test
