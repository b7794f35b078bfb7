// Parallel loops: the only access to threads. Results do not depend on the number of threads: iterations are
// independent, and reductions combine in index order.
//
// Guarantees of all loops:
// - A loop runs all its iterations or throws. The first exception of a body ends it, even if an exception of another
//   body, or a host's cancellation, stops the enclosing loop.
// - Bodies may start loops. A thread that waits for the end of a loop works only on that loop meanwhile, never on
//   iterations of the enclosing loop or on a host's tasks. It may therefore hold a lock, and `thread_local` variables
//   keep their values. (The recursion of parallel_invoke counts as one loop.)
// - Bodies compute with the floating-point settings of the thread that started the loop.
// - Process-wide settings stay unchanged: see ThreadScope.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "sansmesh/threads.h"

namespace sansmesh::inline v1 {

namespace detail {
void parallel_ranges(std::size_t begin, std::size_t end, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body);
}

/// Calls body(first, last) on disjoint ranges that cover [begin, end), each of at most `grain` (>= 1) indices. The
/// division into ranges may depend on the number of threads; results must not depend on it.
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

/// Deterministic reduction: divides [0, n) into chunks of exactly `chunk` indices (the last may be shorter), maps each
/// by map(first, last) and combines the values in chunk order.
template <class T, class Map, class Combine>
T parallel_reduce(std::size_t n, std::size_t chunk, const T& init, Map&& map, Combine&& combine) {
  const std::size_t chunks = (n + chunk - 1) / chunk;
  struct Part {  // One object per chunk: bits of std::vector<bool> share words.
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

/// Runs both, possibly concurrently; also for recursion. A branch that waits for its own branches may execute other
/// branches of the same recursion, so it must not hold a lock meanwhile.
void parallel_invoke(const std::function<void()>& a, const std::function<void()>& b);

/// Sorts by operator< in parallel. The order of equal elements is unspecified, so keys must be unique for determinism.
void parallel_sort(std::vector<std::uint64_t>& values);
struct KeyIndex {
  std::uint64_t key;
  unsigned index;
  friend bool operator<(const KeyIndex& a, const KeyIndex& b) {
    return a.key != b.key ? a.key < b.key : a.index < b.index;
  }
};
void parallel_sort(std::vector<KeyIndex>& values);

/// Calls work(), which runs oneTBB loops of another library, on the threads that a loop started here would use.
void lend_threads(const std::function<void()>& work);

}  // namespace sansmesh::inline v1
