// Which source implements parallel.h: parallel.cpp on oneTBB, or parallel_watched.cpp where the thread sanitizer looks
// on.
#pragma once

#include <string>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"

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

namespace sansmesh::detail {

inline void check_thread_count(int threads) {
  if (threads < 0 || threads > ThreadScope::kMost)
    throw ArgumentError("threads: " + std::to_string(threads) + " is not a number from 0 to " +
                        std::to_string(ThreadScope::kMost));
}

}  // namespace sansmesh::detail
