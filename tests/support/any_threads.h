// The promise that results do not depend on the number of threads.
#pragma once

#include <gtest/gtest.h>

#include "sansmesh/core/parallel.h"
#include "support/sanitizers.h"

namespace sansmesh::test {

/// What work() returns if its loops have so many threads, also if there are fewer cores.
template <class Work>
auto with_threads(int threads, const Work& work) {
  const ThreadScope scope(threads);
  return work();
}

/// Calls compare(one, many) with what work() returns on one thread, and on 2 and 8. Not under sanitizers of memory:
/// others run the same code once.
template <class Work, class Compare>
void compare_threads(const Work& work, const Compare& compare) {
  if (kAddressSanitizer) GTEST_SKIP() << "the same code three times";
  const auto one = with_threads(1, work);
  for (const int threads : {2, 8}) {
    SCOPED_TRACE(testing::Message() << threads << " threads");
    compare(one, with_threads(threads, work));
  }
}

/// For results that are equal as wholes.
template <class Work>
void expect_equal_for_any_threads(const Work& work) {
  compare_threads(work, [](const auto& one, const auto& many) { EXPECT_TRUE(one == many); });
}

}  // namespace sansmesh::test
