// Cancellation of calls that receive no Progress.
#include "sansmesh/core/cancel_scope.h"

#include <gtest/gtest.h>

#include <atomic>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

TEST(CancelScope, EndsLoopsOnAnyNumberOfThreads) {
  for (const int threads : {1, 4}) {
    const ThreadScope scope(threads);
    Progress progress;
    const CancelScope listening(progress);
    std::atomic<int> done{0};
    EXPECT_THROW(parallel_for(0, 100'000, 10,
                              [&](std::size_t i) {
                                if (i == 0) progress.cancel();
                                ++done;
                              }),
                 Cancelled);
    EXPECT_LT(done, 100'000) << threads;
    EXPECT_THROW(parallel_for(0, 100, 1, [](std::size_t) {}), Cancelled);
    EXPECT_THROW(parallel_invoke([] {}, [] {}), Cancelled);
  }
}

TEST(CancelScope, ReachesLoopsWithinLoops) {
  const ThreadScope scope(4);
  Progress progress;
  const CancelScope listening(progress);
  std::atomic<int> done{0};
  EXPECT_THROW(parallel_for(0, 8, 1,
                            [&](std::size_t i) {
                              parallel_for(0, 100'000, 10, [&](std::size_t k) {
                                if (i == 0 && k == 0) progress.cancel();
                                ++done;
                              });
                            }),
               Cancelled);
  EXPECT_LT(done, 800'000);
}

TEST(CancelScope, TheInnermostCountsAndEndsWithItsScope) {
  Progress outer, inner;
  const CancelScope first(outer);
  {
    const CancelScope second(inner);
    outer.cancel();
    EXPECT_NO_THROW(check_cancelled());
    inner.cancel();
    EXPECT_THROW(check_cancelled(), Cancelled);
  }
  EXPECT_THROW(check_cancelled(), Cancelled);
}

TEST(CancelScope, WithoutOneNothingIsHeard) {
  Progress progress;
  progress.cancel();
  EXPECT_NO_THROW(check_cancelled());
  EXPECT_NO_THROW(parallel_for(0, 1000, 1, [](std::size_t) {}));
}

}  // namespace
}  // namespace sansmesh::inline v1
