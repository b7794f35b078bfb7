// Cancellation of work that is handed no Progress: loops, readers of files, waits.
#pragma once

#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// While it lives, Progress::cancel() ends with Cancelled whatever the calling thread does in loops of parallel.h (on
/// all their threads), in readers and writers of files, and in waits for pipes: at the next range of a loop, block of a
/// file or tenth of a second. It must end on the same thread, in reverse order of scopes (a local variable). Of scopes
/// within each other the innermost counts.
///
///     Progress progress;
///     const CancelScope scope(progress);
///     const PointSet points = read_points(file);  // ends when another thread calls progress.cancel()
class CancelScope {
 public:
  explicit CancelScope(const Progress& progress);
  ~CancelScope();
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;

 private:
  const Progress* before_;
};

/// Throws Cancelled after cancel() of the Progress whose scope the calling thread is in.
void check_cancelled();

namespace detail {

/// What the calling thread listens to; null: nothing.
const Progress* heard_progress();

/// A thread of a loop listens to what the loop's caller does, as long as this lives. Throws Cancelled if it is
/// cancelled already.
class ListenAs {
 public:
  explicit ListenAs(const Progress* progress);
  ~ListenAs();
  ListenAs(const ListenAs&) = delete;
  ListenAs& operator=(const ListenAs&) = delete;

 private:
  const Progress* before_;
};

}  // namespace detail
}  // namespace sansmesh::inline v1
