// Cancellation of work that is handed no Progress: loops, readers of files, waits.
#pragma once

#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

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
