// How many threads loops may use.
#pragma once

#include <memory>

#include "sansmesh/api.h"

namespace sansmesh::inline v1 {

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
class SANSMESH_API ThreadScope {
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
SANSMESH_API int thread_count();

}  // namespace sansmesh::inline v1
