// The only door to threads. Every loop here gives the same result for any number of threads: iterations are
// independent, and reductions combine in index order.
//
// What all loops promise:
// - A loop has either run all its iterations or throws: the first exception out of a body ends it, also if another
//   body's exception, or a host's cancellation, stops the loop around it.
// - Bodies may start loops themselves. A thread that waits for the end of a loop works on nothing but that loop
//   meanwhile, never on iterations of the loop around it or on a host's own tasks: so it may hold a lock, and what is
//   `thread_local` stays as the body left it. (The recursion of parallel_invoke is one loop.)
// - Bodies compute with the floating-point settings of the thread that started the loop.
// - Nothing of the process is changed: see ThreadScope.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace sansmesh {

/// Says how many threads the loops may use that the calling thread starts, itself included, and all loops within those:
/// as long as the object lives, which must end on the same thread, in reverse order of scopes (a local variable).
///
///     {
///       const ThreadScope two(2);
///       mesh = reconstruct(points, options, progress);  // on this thread and one more
///     }
///
/// Without a scope loops run where the calling thread is: in the oneTBB arena of a host, or on all cores. A scope has
/// an arena of its own, and what a host says in oneTBB about other arenas, about the whole process, and what it runs on
/// other threads stays as it is. If a host limits the whole process to fewer threads (`tbb::global_control`), fewer
/// take part; a scope of more threads than there are cores lifts oneTBB's own limit to its size as long as it lives.
class ThreadScope {
 public:
  static constexpr int kMost = 1024;

  /// 1 to kMost threads; 0 means all cores that the process may use. Throws ArgumentError for other numbers.
  explicit ThreadScope(int threads);
  ~ThreadScope();
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

  struct Team;

 private:
  std::unique_ptr<Team> team_;
};

/// How many threads a loop that starts here may use.
int thread_count();

namespace detail {
void parallel_ranges(std::size_t begin, std::size_t end, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body);
}

/// Calls body(first, last) on disjoint ranges that cover [begin, end), each at most `grain` long (1 or more).
/// The cut into ranges may depend on the thread count: body must not let it show in its results.
template <class Body>
void parallel_ranges(std::size_t begin, std::size_t end, std::size_t grain, Body&& body) {
  if (begin >= end) return;
  if (end - begin <= grain) return body(begin, end);
  detail::parallel_ranges(begin, end, grain, std::ref(body));
}

/// Calls body(i) for every i in [begin, end).
template <class Body>
void parallel_for(std::size_t begin, std::size_t end, std::size_t grain, Body&& body) {
  parallel_ranges(begin, end, grain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) body(i);
  });
}

/// Cuts [0, n) into chunks of exactly `chunk` (the last may be shorter), maps each to a value by map(first, last) and
/// combines the values in chunk order: deterministic floating-point reductions.
template <class T, class Map, class Combine>
T parallel_reduce(std::size_t n, std::size_t chunk, const T& init, Map&& map, Combine&& combine) {
  const std::size_t chunks = (n + chunk - 1) / chunk;
  struct Part {  // one object per chunk, whatever T: bits of std::vector<bool> share their words
    T value;
  };
  std::vector<Part> parts(chunks, Part{init});
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    const std::size_t first = c * chunk;
    parts[c].value = map(first, first + chunk < n ? first + chunk : n);
  });
  T result = init;
  for (const Part& part : parts) result = combine(result, part.value);
  return result;
}

/// Runs both, possibly at the same time. For recursion, too: a branch that waits for its own branches may be given
/// other branches of the same recursion, so it must not hold a lock meanwhile.
void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b);

/// Sorts by operator< in parallel; equal elements keep no particular order, so keys must be unique for determinism.
void parallel_sort(std::vector<std::uint64_t>& values);
struct KeyIndex {
  std::uint64_t key;
  unsigned index;
  friend bool operator<(const KeyIndex& a, const KeyIndex& b) {
    return a.key != b.key ? a.key < b.key : a.index < b.index;
  }
};
void parallel_sort(std::vector<KeyIndex>& values);

/// Calls work(), which runs loops of another library's on oneTBB: they use the threads that a loop started here would.
void lend_threads(const std::function<void()>& work);

}  // namespace sansmesh
