#include "sansmesh/core/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <chrono>
#include <cstdlib>
#include <numeric>
#include <random>
#include <thread>

#include "core/parallel_test_tools.h"
#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/parallel_backend.h"
#include "sansmesh/progress.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

TEST(Parallel, VisitsEveryIndexOnce) {
  std::vector<int> seen(10007, 0);
  parallel_for(0, seen.size(), 64, [&](std::size_t i) { ++seen[i]; });
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size()));
}

TEST(Parallel, ReductionDoesNotDependOnThreadCount) {
  std::vector<float> values(100003);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 1.0f / static_cast<float>(i + 1);
  test::expect_equal_for_any_threads([&] {
    return parallel_reduce(
        values.size(), 1000, 0.0f,
        [&](std::size_t a, std::size_t b) { return std::accumulate(&values[a], &values[a] + (b - a), 0.0f); },
        [](float a, float b) { return a + b; });
  });
}

TEST(Parallel, ReductionOfTruthValuesLosesNone) {
  // Several threads write values of neighbouring chunks concurrently.
  const ThreadScope eight(8);
  for (int round = 0; round < 20; ++round) {
    std::size_t holds = 0;
    parallel_reduce(
        std::size_t{1} << 16, 1, false, [](std::size_t, std::size_t) { return true; },
        [&](bool, bool part) { return holds += part, part; });
    EXPECT_EQ(holds, std::size_t{1} << 16);
  }
}

TEST(Parallel, SortsAsOneThreadDoes) {
  std::mt19937_64 random(1);
  std::vector<std::uint64_t> values(100000);
  std::vector<KeyIndex> keys;
  for (std::uint64_t& v : values) v = random();
  for (unsigned i = 0; i < 100000; ++i) keys.push_back({random() % 1000, i});
  std::vector<std::uint64_t> sorted = values;
  std::vector<KeyIndex> sorted_keys = keys;
  std::sort(sorted.begin(), sorted.end());
  std::sort(sorted_keys.begin(), sorted_keys.end());
  for (const int threads : {1, 2, 8}) {
    const ThreadScope scope(threads);
    std::vector<std::uint64_t> v = values;
    std::vector<KeyIndex> k = keys;
    parallel_sort(v);
    parallel_sort(k);
    EXPECT_EQ(v, sorted);
    EXPECT_TRUE(std::equal(k.begin(), k.end(), sorted_keys.begin(), sorted_keys.end(),
                           [](const KeyIndex& a, const KeyIndex& b) { return a.key == b.key && a.index == b.index; }));
  }
}

#if SANSMESH_WATCHED_THREADS
TEST(Parallel, RacesOfBodiesAreSeen) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const ThreadScope two(2);
  int sum = 0;
  const auto add = [&](std::size_t) { ++sum; };
  EXPECT_EXIT((parallel_for(0, 2, 1, add), std::exit(0)), testing::ExitedWithCode(66), "data race");
  EXPECT_EXIT((parallel_invoke([&] { add(0); }, [&] { add(1); }), std::exit(0)), testing::ExitedWithCode(66),
              "data race");
}
#endif

TEST(ThreadScope, AsManyThreadsTakePartAsWereAskedFor) {
  for (const int threads : {2, 8, 3, 8}) {
    const ThreadScope scope(threads);
    EXPECT_EQ(thread_count(), threads);
    test::MeetingPlace place(threads);
    std::atomic<int> met = 0;
    parallel_for(0, static_cast<std::size_t>(threads), 1, [&](std::size_t) { met += place.arrive(); });
    EXPECT_EQ(met, threads);
  }
}

TEST(ThreadScope, HoldsForTheCallingThreadAndUntilItsEnd) {
  const auto count_on_another = [] {
    int count = 0;
    std::thread([&] { count = thread_count(); }).join();
    return count;
  };
  const int without = thread_count(), others = count_on_another();
  {
    const ThreadScope five(5);
    EXPECT_EQ(thread_count(), 5);
    {
      const ThreadScope three(3);
      EXPECT_EQ(thread_count(), 3);
      parallel_for(0, 3, 1, [](std::size_t) { EXPECT_EQ(thread_count(), 3); });
    }
    EXPECT_EQ(thread_count(), 5);
    EXPECT_EQ(count_on_another(), others);
    parallel_for(0, 5, 1, [](std::size_t) {
      const ThreadScope two(2);
      EXPECT_EQ(thread_count(), 2);
      test::MeetingPlace place(2);
      parallel_for(0, 2, 1, [&](std::size_t) { EXPECT_TRUE(place.arrive()); });
    });
    parallel_for(0, 5, 1, [](std::size_t) { EXPECT_EQ(thread_count(), 5); });
  }
  EXPECT_EQ(thread_count(), without);
}

TEST(ThreadScope, RefusesNumbersOutOfRange) {
  EXPECT_THROW(ThreadScope(-1), ArgumentError);
  EXPECT_THROW(ThreadScope(ThreadScope::kMost + 1), ArgumentError);
  EXPECT_GE(test::with_threads(0, thread_count), 1);
}

TEST(Parallel, WhoWaitsInALoopIsNotGivenTheLoopAround) {
  const ThreadScope scope(4);
  std::atomic<int> entered_again = 0;
  parallel_for(0, 100, 1, [&](std::size_t) {
    entered_again += test::Door().enter();
    test::wait_in_a_loop();
    std::vector<std::uint64_t> values(3000);
    std::iota(values.rbegin(), values.rend(), 0);
    parallel_sort(values);
    parallel_invoke(test::wait_in_a_loop, test::wait_in_a_loop);
    test::Door().leave();
  });
  EXPECT_EQ(entered_again, 0);
}

TEST(Parallel, AnExceptionEndsTheLoopAndReachesTheCaller) {
  for (const int threads : {1, 2, 8}) {
    const ThreadScope scope(threads);
    EXPECT_THROW(parallel_for(0, 1000, 1,
                              [](std::size_t i) {
                                if (i == 500) throw Cancelled();
                              }),
                 Cancelled);
    const auto fails = [] { throw DataError("no use"); };
    const auto works = [] {};
    EXPECT_THROW(parallel_invoke(fails, works), DataError);
    EXPECT_THROW(parallel_invoke(works, fails), DataError);
    EXPECT_THROW(lend_threads(fails), DataError);
    EXPECT_THROW(parallel_for(0, 10, 1, [&](std::size_t) { parallel_for(0, 10, 1, [&](std::size_t) { fails(); }); }),
                 DataError);
  }
}

TEST(Parallel, AnExceptionElsewhereLeavesNoLoopHalfDone) {
  // The second iteration continues after the first has failed.
  const ThreadScope scope(4);
  std::atomic<bool> failed = false;
  std::atomic<std::size_t> done = 0, branches = 0;
  std::vector<std::uint64_t> values(50000);
  std::iota(values.rbegin(), values.rend(), 0);
  test::MeetingPlace both(2);
  EXPECT_THROW(parallel_for(0, 2, 1,
                            [&](std::size_t i) {
                              ASSERT_TRUE(both.arrive());
                              if (i == 0) {
                                failed = true;
                                throw DataError("no use");
                              }
                              while (!failed) std::this_thread::yield();
                              std::this_thread::sleep_for(std::chrono::milliseconds(20));
                              parallel_for(0, 1000, 1, [&](std::size_t) { ++done; });
                              parallel_invoke([&] { ++branches; }, [&] { ++branches; });
                              parallel_sort(values);
                            }),
               DataError);
  EXPECT_EQ(done, 1000u);
  EXPECT_EQ(branches, 2u);
  EXPECT_TRUE(std::is_sorted(values.begin(), values.end()));
}

std::size_t count_leaves(std::size_t depth) {
  if (depth == 0) return 1;
  std::size_t a = 0, b = 0;
  parallel_invoke([&] { a = count_leaves(depth - 1); }, [&] { b = count_leaves(depth - 1); });
  return a + b;
}

TEST(Parallel, BranchesMayBranch) {
  for (const int threads : {1, 2, 8}) EXPECT_EQ(test::with_threads(threads, [] { return count_leaves(10); }), 1024u);
}

TEST(Parallel, BodiesRoundAsTheCallerDoes) {
  const ThreadScope scope(4);
  test::MeetingPlace first(4), then(4);
  parallel_for(0, 4, 1, [&](std::size_t) { first.arrive(); });  // starts the workers
  const int before = std::fegetround();
  ASSERT_EQ(std::fesetround(FE_UPWARD), 0);
  parallel_for(0, 4, 1, [&](std::size_t) {
    EXPECT_TRUE(then.arrive());
    EXPECT_EQ(std::fegetround(), FE_UPWARD);
  });
  std::fesetround(before);
}

TEST(Progress, CancelThrowsAtTheNextStep) {
  Progress progress;
  progress.begin("work", 10);
  progress.advance();
  progress.cancel();
  EXPECT_THROW(progress.advance(), Cancelled);
}

TEST(Progress, LoopsOfACancelledScopeEndBeforeTheirNextRange) {
  for (const int threads : {1, 4}) {
    const ThreadScope scope(threads);
    Progress progress;
    std::atomic<std::size_t> visited{0};
    const auto work = [&] {
      const CancelScope listening(progress);
      parallel_for(0, 100'000, 1, [&](std::size_t) {
        parallel_for(0, 10, 1, [&](std::size_t) {
          if (++visited == 50) progress.cancel();
        });
      });
    };
    EXPECT_THROW(work(), Cancelled);
    EXPECT_GE(visited, 50u);
    EXPECT_LT(visited, 200u) << "loops within loops listen, too";
    EXPECT_THROW(work(), Cancelled) << "loops do not begin either";
    EXPECT_EQ(detail::observed_progress(), nullptr);
    parallel_for(0, 1000, 1, [&](std::size_t) { ++visited; });
    EXPECT_GE(visited, 1050u) << "nothing listens outside of the scope";
  }
}

TEST(Progress, TheInnermostScopeCounts) {
  Progress outer, inner;
  outer.cancel();
  const CancelScope listening(outer);
  EXPECT_THROW(check_cancelled(), Cancelled);
  {
    const CancelScope other(inner);
    EXPECT_NO_THROW(check_cancelled());
  }
  EXPECT_THROW(check_cancelled(), Cancelled);
}

TEST(Progress, RecordsStagesInOrder) {
  std::vector<double> fractions;
  Progress progress([&](const std::string&, double f) { fractions.push_back(f); });
  progress.begin("one", 2);
  progress.advance();
  progress.advance();
  progress.begin("two");
  progress.finish();
  ASSERT_EQ(progress.timings().size(), 2u);
  EXPECT_EQ(progress.timings()[0].stage, "one");
  EXPECT_EQ(progress.timings()[1].stage, "two");
  EXPECT_TRUE(std::find(fractions.begin(), fractions.end(), 0.5) != fractions.end());
}

}  // namespace
}  // namespace sansmesh::inline v1
