// Progress and cancellation of long work, passed by reference. Cheap enough for inner blocks; safe from any thread.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

/// Progress and cancellation of one job. Stages are entered in sequence by the algorithm (`begin`), advanced by its
/// workers (`advance`), and observed by the caller: through a callback, or by a class that overrides `report` and
/// `wants_stop`. Wall time of each finished stage is kept (`timings`). Not copied or moved; the caller keeps it until
/// the job has returned. One object serves one job at a time.
class SANSMESH_API Progress {
 public:
  /// Called with the stage's name and the fraction done in [0, 1], from one thread at a time, at most ~100 times a
  /// stage.
  using Callback = std::function<void(const std::string& stage, double fraction)>;

  /// Without a callback.
  Progress();
  /// Reports to `callback`, which may call cancel() but no other function of this object.
  explicit Progress(Callback callback);
  virtual ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Ends the current stage and starts another of `total` work units. Throws Cancelled after cancel().
  void begin(const std::string& stage, std::size_t total = 1);
  /// Reports `units` of work done; throws Cancelled after cancel().
  void advance(std::size_t units = 1);
  /// Ends the current stage, if there is one, and keeps its times.
  void finish();

  /// Asks the job to stop: its next begin(), advance() or check() throws Cancelled. Safe from any thread and from the
  /// callback; cannot be taken back.
  void cancel();
  /// Throws Cancelled after cancel(), or once `wants_stop` says so.
  void check() const;

  /// Time that a finished stage took.
  struct Timing {
    std::string stage;        ///< name
    double wall_seconds = 0;  ///< from its begin() to its end
    double cpu_seconds = 0;   ///< of the whole process meanwhile, all threads (process_cpu_seconds)
  };
  /// Finished stages in the order they ran. To be read once the job has returned: it is not guarded against a stage
  /// that ends meanwhile.
  const std::vector<Timing>& timings() const;

 protected:
  /// As Callback is called, which it calls itself unless it is overridden. Exceptions end the job.
  virtual void report(const std::string& stage, double fraction);
  /// Asked at every check point, from any thread: true cancels the job. Should be quick.
  virtual bool wants_stop() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// While it lives, Progress::cancel() ends with Cancelled whatever the calling thread does in loops of the library (on
/// all their threads), in readers and writers of files, and in waits for pipes: at the next range of a loop, block of a
/// file or tenth of a second. It must end on the same thread, in reverse order of scopes (a local variable). Of scopes
/// within each other the innermost counts.
///
///     Progress progress;
///     const CancelScope scope(progress);
///     const PointSet points = read_points(file);  // ends when another thread calls progress.cancel()
class SANSMESH_API CancelScope {
 public:
  /// Begins; `progress` stays until the scope ends.
  explicit CancelScope(const Progress& progress);
  ~CancelScope();
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;

 private:
  const Progress* before_;
};

/// CPU seconds (user + system, all threads) this process has used so far.
SANSMESH_API double process_cpu_seconds();

}  // namespace sansmesh::inline v1
