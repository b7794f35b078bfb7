// Cancellation of work that receives no Progress: loops, file readers, waits.
#pragma once

#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Throws Cancelled after cancel() of the Progress whose CancelScope encloses the call.
void check_cancelled();

namespace detail {

/// Progress that the calling thread observes; null if there is none.
const Progress* observed_progress();

/// Makes a worker thread observe the Progress of the loop's caller while this object lives. Throws Cancelled if it is
/// already cancelled.
class ObserveAs {
 public:
  explicit ObserveAs(const Progress* progress);
  ~ObserveAs();
  ObserveAs(const ObserveAs&) = delete;
  ObserveAs& operator=(const ObserveAs&) = delete;

 private:
  const Progress* before_;
};

}  // namespace detail
}  // namespace sansmesh::inline v1
