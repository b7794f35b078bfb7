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
#include <vector>

#include "sansmesh/threads.h"

namespace sansmesh::inline v1 {

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

}  // namespace sansmesh::inline v1
