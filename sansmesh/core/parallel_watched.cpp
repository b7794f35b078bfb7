// Parallel loops in builds with the thread sanitizer, on threads of the standard library. oneTBB is not built with the
// sanitizer, which would report its synchronisation as races; suppressing all stacks with oneTBB frames would suppress
// every race of the library. Here the sanitizer sees everything. To expose races, neighbouring chunks always run on
// different threads, and only the start and the end of a thread order its work.
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/parallel_backend.h"
#if SANSMESH_WATCHED_THREADS

#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "sansmesh/core/cancel_scope.h"

namespace sansmesh::inline v1 {
namespace {

/// Threads without a scope; may exceed the number of cores, so that races show.
constexpr int kThreads = 4;
/// Deeper nested loops run sequentially, which bounds the number of threads.
constexpr int kDeepest = 2;

struct LoopState {
  int threads = kThreads;
  int depth = 0;  // number of enclosing loops
};
thread_local LoopState loop_state;

/// Calls work(c) for all c < count.
template <class Work>
void run(std::size_t count, const Work& work) {
  const LoopState here = loop_state;
  const Progress* const progress = detail::observed_progress();
  const auto threads = here.depth < kDeepest ? std::min(count, static_cast<std::size_t>(here.threads)) : 1;
  if (threads <= 1) {
    for (std::size_t c = 0; c < count; ++c) {
      check_cancelled();
      work(c);
    }
    return;
  }
  std::mutex mutex;
  std::exception_ptr error;
  std::atomic<bool> failed = false;
  const auto share = [&](std::size_t thread) {
    const LoopState before = std::exchange(loop_state, {here.threads, here.depth + 1});
    try {
      for (std::size_t c = thread; c < count && !failed.load(std::memory_order_relaxed); c += threads) {
        const detail::ObserveAs caller(progress);
        work(c);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!error) error = std::current_exception();
      failed.store(true, std::memory_order_relaxed);
    }
    loop_state = before;
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t thread = 1; thread < threads; ++thread) others.emplace_back(share, thread);
    share(0);
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace

struct ThreadScope::Team {
  explicit Team(int threads) : outer(std::exchange(loop_state, {threads, 0})) {}
  ~Team() { loop_state = outer; }
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  LoopState outer;
};

ThreadScope::ThreadScope(int threads) {
  detail::check_thread_count(threads, kMost);
  team_ = std::make_unique<Team>(threads == 0 ? kThreads : threads);
}
ThreadScope::~ThreadScope() = default;

int thread_count() { return loop_state.threads; }

void detail::parallel_ranges(std::size_t begin, std::size_t end, std::size_t grain,
                             const std::function<void(std::size_t, std::size_t)>& body) {
  run((end - begin + grain - 1) / grain, [&](std::size_t c) {
    const std::size_t first = begin + c * grain;
    body(first, first + std::min(grain, end - first));
  });
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
  run(2, [&](std::size_t c) { c == 0 ? a() : b(); });
}

void parallel_sort(std::vector<std::uint64_t>& values) { std::sort(values.begin(), values.end()); }
void parallel_sort(std::vector<KeyIndex>& values) { std::sort(values.begin(), values.end()); }

void lend_threads(const std::function<void()>& work) { tbb::task_arena(1).execute(work); }

}  // namespace sansmesh::inline v1
#endif
