// Progress and cancellation of long jobs, passed by reference. Cheap enough for inner loops; thread-safe.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

/// Progress and cancellation of one job. The algorithm enters stages in sequence (`begin`), its workers advance them
/// (`advance`), and the caller observes them through a callback or a class that overrides `report` and `wants_stop`.
/// Keeps the times of finished stages (`timings`). Neither copyable nor movable; the caller keeps it until the job has
/// returned. One object serves one job at a time.
class SANSMESH_API Progress {
 public:
  /// Receives the stage's name and the fraction done in [0, 1]. Called from one thread at a time, at most ~100 times
  /// per stage.
  using Callback = std::function<void(const std::string& stage, double fraction)>;

  /// Progress without a callback.
  Progress();
  /// Reports to `callback`, which may call cancel() but no other function of this object.
  explicit Progress(Callback callback);
  virtual ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Ends the current stage and starts another of `total` work units. Throws Cancelled after cancel().
  void begin(const std::string& stage, std::size_t total = 1);
  /// Reports `units` of work as done; throws Cancelled after cancel().
  void advance(std::size_t units = 1);
  /// Ends the current stage, if any, and keeps its times.
  void finish();

  /// Requests the job to stop: its next begin(), advance() or check() throws Cancelled. Callable from any thread and
  /// from the callback; irrevocable.
  void cancel();
  /// Throws Cancelled after cancel(), or once `wants_stop` returns true.
  void check() const;

  /// Time of a finished stage.
  struct Timing {
    std::string stage;        ///< name of the stage
    double wall_seconds = 0;  ///< wall time of the stage
    double cpu_seconds = 0;   ///< CPU time of the whole process during the stage, all threads (process_cpu_seconds)
  };
  /// Finished stages in their order. Read it after the job has returned: access is not synchronised with stages that
  /// end meanwhile.
  const std::vector<Timing>& timings() const;

 protected:
  /// Called as Callback is; the default implementation calls the callback. Exceptions end the job.
  virtual void report(const std::string& stage, double fraction);
  /// Called at every check point, from any thread: true cancels the job. Must be fast.
  virtual bool wants_stop() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// While a scope lives, Progress::cancel() ends with Cancelled the library's loops (on all their threads), file readers
/// and writers, and waits for pipes that the calling thread starts: at the next range of a loop, block of a file or
/// tenth of a second. It must end on the same thread, in reverse order of construction (a local variable). The
/// innermost of nested scopes counts.
///
///     Progress progress;
///     const CancelScope scope(progress);
///     const PointSet points = read_points(file);  // ends when another thread calls progress.cancel()
class SANSMESH_API CancelScope {
 public:
  /// Opens the scope; `progress` must outlive it.
  explicit CancelScope(const Progress& progress);
  ~CancelScope();
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;

 private:
  const Progress* before_;
};

/// CPU seconds (user + system, all threads) of this process so far.
SANSMESH_API double process_cpu_seconds();

}  // namespace sansmesh::inline v1
