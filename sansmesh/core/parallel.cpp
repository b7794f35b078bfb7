// Parallel loops on oneTBB. See parallel_watched.cpp for builds with the thread sanitizer.
#include "sansmesh/core/parallel.h"

#include "sansmesh/core/parallel_backend.h"
#if !SANSMESH_WATCHED_THREADS

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <mutex>
#include <utility>

#include "sansmesh/core/cancel_scope.h"

namespace sansmesh::inline v1 {
namespace {

using tbb::global_control;

/// oneTBB limits the workers of the whole process to the number of cores, even for larger arenas. This class raises
/// that limit as long as a scope needs more.
class WorkerLimit {
 public:
  static void lift(int threads) {
    const std::lock_guard lock(mutex());
    sizes().push_back(threads);
    renew();
  }
  static void restore(int threads) {
    const std::lock_guard lock(mutex());
    sizes().erase(std::find(sizes().begin(), sizes().end(), threads));
    renew();
  }

 private:
  // Never destroyed: a scope may end during program exit.
  static std::mutex& mutex() {
    static auto* const m = new std::mutex;
    return *m;
  }
  static std::vector<int>& sizes() {
    static auto* const s = new std::vector<int>;
    return *s;
  }
  static std::unique_ptr<global_control>& control() {
    static auto* const c = new std::unique_ptr<global_control>;
    return *c;
  }

  /// The least limit in a process applies: this one must never lower a host's.
  static void renew() {
    control().reset();  // the remaining limit is the host's
    if (sizes().empty()) return;
    const auto most = static_cast<std::size_t>(*std::max_element(sizes().begin(), sizes().end()));
    if (global_control::active_value(global_control::max_allowed_parallelism) >= most) return;
    control() = std::make_unique<global_control>(global_control::max_allowed_parallelism, most);
  }
};

/// State of a thread within the library's loops.
struct LoopState {
  ThreadScope::Team* team = nullptr;  // scope of the loops; null: the current arena
  bool inside = false;                // in a loop body: already in the arena
  bool branch = false;                // in a branch of parallel_invoke
};
thread_local LoopState loop_state;

}  // namespace

/// Threads of a scope.
struct ThreadScope::Team {
  explicit Team(int count) : threads(count), arena(count) {
    if (threads > tbb::info::default_concurrency()) WorkerLimit::lift(threads);
    outer = std::exchange(loop_state, {this});
  }
  ~Team() {
    loop_state = outer;
    arena.terminate();
    if (threads > tbb::info::default_concurrency()) WorkerLimit::restore(threads);
  }
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  int threads;
  tbb::task_arena arena;  // starts with the first loop
  LoopState outer;        // state of the thread that opened the scope
};

namespace {

/// Sets the thread's state during a body.
class At {
 public:
  explicit At(const LoopState& here) : before_(std::exchange(loop_state, here)) {}
  ~At() { loop_state = before_; }
  At(const At&) = delete;
  At& operator=(const At&) = delete;

 private:
  LoopState before_;
};

/// Belongs to one loop only, so that stopping an enclosing loop does not leave it incomplete. Passes the floating-point
/// settings of the thread that makes it to all threads of the loop.
class Context : public tbb::task_group_context {
 public:
  Context() : task_group_context(task_group_context::isolated, task_group_context::fp_settings) {}
};

/// Calls work(context) in the arena of the thread's scope.
template <class Work>
void enter(const LoopState& here, const Work& work) {
  Context context;  // constructed before the thread enters the arena, which has its own settings
  const auto start = [&] { work(context); };
  if (here.team != nullptr && !here.inside)
    here.team->arena.execute(start);  // no other work waits in this arena, so the thread cannot pick up any
  else
    tbb::this_task_arena::isolate(start);
}

/// Same, for work that starts its oneTBB loops without a context.
template <class Work>
void enter_as_task(const Work& work) {
  const LoopState here = loop_state;
  enter(here, [&](tbb::task_group_context& context) {
    tbb::task_group group(context);
    group.run_and_wait([&] {
      const At at({here.team, true});
      work();
    });
  });
}

bool alone(const LoopState& here) { return here.team != nullptr && here.team->threads == 1; }

template <class T>
void sort(std::vector<T>& values) {
  if (alone(loop_state)) return std::sort(values.begin(), values.end());
  enter_as_task([&] { tbb::parallel_sort(values.begin(), values.end()); });
}

}  // namespace

ThreadScope::ThreadScope(int threads) {
  detail::check_thread_count(threads, kMost);
  team_ = std::make_unique<Team>(threads == 0 ? tbb::info::default_concurrency() : threads);
}
ThreadScope::~ThreadScope() = default;

int thread_count() {
  const auto most = static_cast<int>(
      std::min<std::size_t>(ThreadScope::kMost, global_control::active_value(global_control::max_allowed_parallelism)));
  return std::min(most,
                  loop_state.team != nullptr ? loop_state.team->threads : tbb::this_task_arena::max_concurrency());
}

void detail::parallel_ranges(std::size_t begin, std::size_t end, std::size_t grain,
                             const std::function<void(std::size_t, std::size_t)>& body) {
  const LoopState here = loop_state;
  if (alone(here)) {
    for (std::size_t first = begin; first < end; first += std::min(grain, end - first)) {
      check_cancelled();
      body(first, std::min(end, first + grain));
    }
    return;
  }
  const Progress* const progress = observed_progress();
  enter(here, [&](tbb::task_group_context& context) {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(begin, end, grain),
        [&](const tbb::blocked_range<std::size_t>& r) {
          const At at({here.team, true});
          const ObserveAs caller(progress);
          body(r.begin(), r.end());
        },
        tbb::simple_partitioner(), context);
  });
}

void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b) {
  const LoopState here = loop_state;
  if (alone(here)) {
    check_cancelled();
    a();
    b();
    return;
  }
  const Progress* const progress = detail::observed_progress();
  const auto branch = [&](const std::function<void()>& work) {
    return [&] {
      const At at({here.team, true, true});
      const detail::ObserveAs caller(progress);
      work();
    };
  };
  const auto start = [&](tbb::task_group_context& context) { tbb::parallel_invoke(branch(a), branch(b), context); };
  if (!here.branch) return enter(here, start);
  // A whole recursion is one loop: only then can a thread that waits for one branch help with others.
  Context context;
  start(context);
}

void parallel_sort(std::vector<std::uint64_t>& values) { sort(values); }
void parallel_sort(std::vector<KeyIndex>& values) { sort(values); }

void lend_threads(const std::function<void()>& work) { enter_as_task(work); }

}  // namespace sansmesh::inline v1
#endif
