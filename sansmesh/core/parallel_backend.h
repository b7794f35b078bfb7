// Common parts of the two implementations of parallel.h, and the choice between them: parallel.cpp uses oneTBB,
// parallel_watched.cpp serves builds with the thread sanitizer.
#pragma once

#include <string>

#include "sansmesh/error.h"

#if defined(__SANITIZE_THREAD__)
#define SANSMESH_WATCHED_THREADS 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define SANSMESH_WATCHED_THREADS 1
#endif
#endif
#ifndef SANSMESH_WATCHED_THREADS
#define SANSMESH_WATCHED_THREADS 0
#endif

namespace sansmesh::inline v1::detail {

/// Throws ArgumentError unless 0 <= threads <= most.
inline void check_thread_count(int threads, int most) {
  if (threads < 0 || threads > most)
    throw ArgumentError("threads: " + std::to_string(threads) + " is not a number from 0 to " + std::to_string(most));
}

}  // namespace sansmesh::inline v1::detail
