#include "sansmesh/core/parallel.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <thread>
#include <utility>

#include "sansmesh/core/progress.h"
#include "support/any_threads.h"

namespace sansmesh {
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
  // Values of neighbouring chunks are written by several threads at a time.
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

/// Those who arrive wait for each other, though not for ever.
class MeetingPlace {
 public:
  explicit MeetingPlace(std::ptrdiff_t expected) : expected_(expected) {}
  /// Whether all came.
  bool arrive() {
    std::unique_lock lock(mutex_);
    if (++arrived_ >= expected_) all_.notify_all();
    return all_.wait_for(lock, std::chrono::seconds(10), [&] { return arrived_ >= expected_; });
  }

 private:
  std::ptrdiff_t expected_, arrived_ = 0;
  std::mutex mutex_;
  std::condition_variable all_;
};

TEST(ThreadScope, AsManyThreadsTakePartAsWereAskedFor) {
  for (const int threads : {2, 8, 3, 8}) {
    const ThreadScope scope(threads);
    EXPECT_EQ(thread_count(), threads);
    MeetingPlace place(threads);
    std::atomic<int> met = 0;
    parallel_for(0, static_cast<std::size_t>(threads), 1, [&](std::size_t) { met += place.arrive(); });
    EXPECT_EQ(met, threads);
  }
}

TEST(ThreadScope, NoMoreThreadsTakePartThanWereAskedFor) {
  for (const int threads : {1, 2, 3}) {
    const ThreadScope scope(threads);
    std::mutex mutex;
    std::set<std::thread::id> seen;
    const auto look = [&](std::size_t) {
      std::this_thread::sleep_for(std::chrono::microseconds(200));
      const std::lock_guard lock(mutex);
      seen.insert(std::this_thread::get_id());
    };
    parallel_for(0, 20, 1, [&](std::size_t) { parallel_for(0, 10, 1, look); });
    lend_threads([&] { tbb::parallel_for(std::size_t{0}, std::size_t{200}, look); });
    EXPECT_GE(seen.size(), 1u);
    EXPECT_LE(seen.size(), static_cast<std::size_t>(threads));
  }
}

TEST(ThreadScope, HoldsForTheCallingThreadAndUntilItsEnd) {
  const int without = thread_count();
  {
    const ThreadScope five(5);
    EXPECT_EQ(thread_count(), 5);
    {
      const ThreadScope three(3);
      EXPECT_EQ(thread_count(), 3);
      parallel_for(0, 3, 1, [](std::size_t) { EXPECT_EQ(thread_count(), 3); });
    }
    EXPECT_EQ(thread_count(), 5);
    int of_other = 0;
    std::thread([&] { of_other = thread_count(); }).join();
    EXPECT_EQ(of_other, without);
    parallel_for(0, 5, 1, [](std::size_t) {
      const ThreadScope two(2);
      EXPECT_EQ(thread_count(), 2);
      MeetingPlace place(2);
      parallel_for(0, 2, 1, [&](std::size_t) { EXPECT_TRUE(place.arrive()); });
    });
    parallel_for(0, 5, 1, [](std::size_t) { EXPECT_EQ(thread_count(), 5); });
  }
  EXPECT_EQ(thread_count(), without);
}

TEST(ThreadScope, RefusesNumbersOutOfRange) {
  EXPECT_THROW(ThreadScope(-1), ArgumentError);
  EXPECT_THROW(ThreadScope(ThreadScope::kMost + 1), ArgumentError);
  EXPECT_EQ(test::with_threads(0, thread_count), tbb::info::default_concurrency());
}

constexpr auto kWorkers = tbb::global_control::max_allowed_parallelism;
std::size_t workers_of_process() { return tbb::global_control::active_value(kWorkers); }

TEST(ThreadScope, LeavesNoTraceInTheProcess) {
  const std::size_t before = workers_of_process();
  const int here = tbb::this_task_arena::max_concurrency();
  {
    const ThreadScope outer(8);
    const ThreadScope inner(50);
    parallel_for(0, 100, 1, [](std::size_t) {});
    EXPECT_EQ(tbb::this_task_arena::max_concurrency(), here) << "the arena of the calling thread";
  }
  test::with_threads(1, [] {
    parallel_for(0, 100, 1, [](std::size_t) {});
    return 0;
  });
  EXPECT_EQ(workers_of_process(), before);
  EXPECT_EQ(tbb::this_task_arena::max_concurrency(), here);
}

TEST(ThreadScope, NeverRaisesNorLowersTheLimitOfAHost) {
  const std::size_t cores = static_cast<std::size_t>(tbb::info::default_concurrency());
  for (const std::size_t allowed : {std::size_t{1}, cores + 20}) {
    const tbb::global_control host(kWorkers, allowed);
    for (const int threads : {1, 2, static_cast<int>(cores) + 10}) {
      const ThreadScope scope(threads);
      EXPECT_EQ(workers_of_process(), allowed);
      EXPECT_EQ(thread_count(), std::min(threads, static_cast<int>(allowed)));
    }
  }
}

TEST(ThreadScope, LoopsOfAHostKeepToItsArena) {
  tbb::task_arena host(1);
  host.execute([] {
    EXPECT_EQ(thread_count(), 1);
    const std::thread::id me = std::this_thread::get_id();
    parallel_for(0, 100, 1, [&](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), me); });
  });
}

/// Says whether a thread enters a second time before it has left.
class Door {
 public:
  bool enter() const { return std::exchange(inside(), true); }
  void leave() const { inside() = false; }

 private:
  static bool& inside() {
    thread_local bool inside = false;
    return inside;
  }
};

void wait_in_a_loop() {
  parallel_for(0, 8, 1, [](std::size_t) { std::this_thread::sleep_for(std::chrono::microseconds(300)); });
}

TEST(Parallel, WhoWaitsInALoopIsNotGivenTheLoopAround) {
  const ThreadScope scope(4);
  std::atomic<int> entered_again = 0;
  parallel_for(0, 100, 1, [&](std::size_t) {
    entered_again += Door().enter();
    wait_in_a_loop();
    std::vector<std::uint64_t> values(3000);
    std::iota(values.rbegin(), values.rend(), 0);
    parallel_sort(values);
    parallel_invoke(wait_in_a_loop, wait_in_a_loop);
    Door().leave();
  });
  EXPECT_EQ(entered_again, 0);
}

TEST(Parallel, WhoWaitsInALoopIsNotGivenTasksOfAHost) {
  const tbb::global_control workers(kWorkers, 4);
  for (const bool own_scope : {false, true}) {
    std::atomic<int> entered_again = 0;
    tbb::task_arena(4).execute([&] {
      tbb::parallel_for(0, 100, [&](int) {
        entered_again += Door().enter();
        std::optional<ThreadScope> scope;
        if (own_scope) scope.emplace(2);
        wait_in_a_loop();
        Door().leave();
      });
    });
    EXPECT_EQ(entered_again, 0);
  }
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
  // The second iteration works on while the first has failed already.
  const ThreadScope scope(4);
  std::atomic<bool> failed = false;
  std::atomic<std::size_t> done = 0, branches = 0;
  std::vector<std::uint64_t> values(50000);
  std::iota(values.rbegin(), values.rend(), 0);
  MeetingPlace both(2);
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
  MeetingPlace first(4), then(4);
  parallel_for(0, 4, 1, [&](std::size_t) { first.arrive(); });  // workers are there already
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
}  // namespace sansmesh
