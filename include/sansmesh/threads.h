// Number of threads for parallel loops.
#pragma once

#include <memory>

#include "sansmesh/api.h"

namespace sansmesh::inline v1 {

/// Sets the number of threads for the loops that the calling thread starts, itself included, and for all loops nested
/// in them, as long as the object lives. It must end on the same thread, in reverse order of construction (a local
/// variable).
///
///     {
///       const ThreadScope two(2);
///       mesh = reconstruct(points, options, progress);  // on this thread and one more
///     }
///
/// Without a scope, loops run in the oneTBB arena of the calling thread's host, or on all cores. A scope has its own
/// arena and leaves a host's settings for other arenas, the whole process and other threads unchanged. If a host limits
/// the whole process to fewer threads (`tbb::global_control`), fewer take part; a scope of more threads than cores
/// raises oneTBB's own limit to its size as long as it lives.
class SANSMESH_API ThreadScope {
 public:
  static constexpr int kMost = 1024;  ///< largest number of threads of a scope

  /// Opens a scope of 1 to kMost threads; 0 means all cores available to the process. Throws ArgumentError for other
  /// numbers.
  explicit ThreadScope(int threads);
  /// Ends the scope; call it on the thread that opened it.
  ~ThreadScope();
  /// Not copyable: a scope belongs to its thread.
  ThreadScope(const ThreadScope&) = delete;
  /// Not assignable.
  ThreadScope& operator=(const ThreadScope&) = delete;

  struct Team;  ///< arena; used only by the library's sources

 private:
  std::unique_ptr<Team> team_;
};

/// Number of threads, the calling one included, that a loop started here may use: at least 1.
SANSMESH_API int thread_count();

}  // namespace sansmesh::inline v1
