// Parallel loops in a program that uses oneTBB itself. Not in builds with the thread sanitizer, which does not support
// oneTBB.
#include "sansmesh/core/parallel_backend.h"
#if !SANSMESH_WATCHED_THREADS

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include "core/parallel_test_tools.h"
#include "sansmesh/core/parallel.h"
#include "support/any_threads.h"

namespace sansmesh::inline v1 {
namespace {

TEST(ThreadsInAHost, NoMoreThreadsTakePartThanWereAskedFor) {
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

constexpr auto kWorkers = tbb::global_control::max_allowed_parallelism;
std::size_t workers_of_process() { return tbb::global_control::active_value(kWorkers); }

TEST(ThreadsInAHost, ZeroThreadsAreAllCores) {
  EXPECT_EQ(test::with_threads(0, thread_count), tbb::info::default_concurrency());
}

TEST(ThreadsInAHost, LeavesNoTraceInTheProcess) {
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

TEST(ThreadsInAHost, NeverRaisesNorLowersTheLimitOfAHost) {
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

TEST(ThreadsInAHost, DoesNotLowerALimitThatAHostSetsMeanwhile) {
  const std::size_t before = workers_of_process(), cores = static_cast<std::size_t>(tbb::info::default_concurrency());
  std::optional<tbb::global_control> host;
  {
    const ThreadScope outer(static_cast<int>(cores) + 6);
    {
      const ThreadScope inner(static_cast<int>(cores) + 40);
      host.emplace(kWorkers, cores + 8);
    }
    EXPECT_EQ(workers_of_process(), cores + 8);
  }
  EXPECT_EQ(workers_of_process(), cores + 8);
  host.reset();
  EXPECT_EQ(workers_of_process(), before);
}

TEST(ThreadsInAHost, LoopsOfAHostKeepToItsArena) {
  tbb::task_arena host(1);
  host.execute([] {
    EXPECT_EQ(thread_count(), 1);
    const std::thread::id me = std::this_thread::get_id();
    parallel_for(0, 100, 1, [&](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), me); });
  });
}

TEST(ThreadsInAHost, WhoWaitsInALoopIsNotGivenTasksOfAHost) {
  const tbb::global_control workers(kWorkers, 4);
  for (const bool own_scope : {false, true}) {
    std::atomic<int> entered_again = 0;
    tbb::task_arena(4).execute([&] {
      tbb::parallel_for(0, 100, [&](int) {
        entered_again += test::Door().enter();
        std::optional<ThreadScope> scope;
        if (own_scope) scope.emplace(2);
        test::wait_in_a_loop();
        test::Door().leave();
      });
    });
    EXPECT_EQ(entered_again, 0);
  }
}

}  // namespace
}  // namespace sansmesh::inline v1
#endif
