// Progress and cancellation of long work, passed by reference. Cheap enough for inner blocks; safe from any thread.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

/// Progress and cancellation of one job. Stages are entered in sequence by the algorithm (`begin`), advanced by its
/// workers (`advance`), and observed by the caller through the callback. Wall time of each finished stage is kept
/// (`timings`). Not copied or moved; must outlive the call it is passed to. One object serves one job at a time.
class SANSMESH_API Progress {
 public:
  /// Called with the stage's name and the fraction done in [0, 1], from one thread at a time, at most ~100 times a
  /// stage.
  using Callback = std::function<void(const std::string& stage, double fraction)>;

  /// Without a callback.
  Progress() = default;
  /// Reports to `callback`, which may call cancel() but no other function of this object.
  explicit Progress(Callback callback) : callback_(std::move(callback)) {}

  /// Ends the current stage and starts another of `total` work units. Throws Cancelled after cancel().
  void begin(const std::string& stage, std::size_t total = 1);
  /// Reports `units` of work done; throws Cancelled after cancel().
  void advance(std::size_t units = 1);
  /// Ends the current stage, if there is one, and keeps its times.
  void finish();

  /// Asks the job to stop: its next begin(), advance() or check() throws Cancelled. Safe from any thread and from the
  /// callback; cannot be taken back.
  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  /// Throws Cancelled after cancel().
  void check() const {
    if (cancelled_.load(std::memory_order_relaxed)) throw Cancelled();
  }

  /// Time that a finished stage took.
  struct Timing {
    std::string stage;        ///< name
    double wall_seconds = 0;  ///< from its begin() to its end
    double cpu_seconds = 0;   ///< of the whole process meanwhile, all threads (process_cpu_seconds)
  };
  /// Finished stages in the order they ran. To be read once the job has returned: it is not guarded against a stage
  /// that ends meanwhile.
  const std::vector<Timing>& timings() const { return timings_; }

 private:
  Callback callback_;
  std::mutex mutex_;
  std::string stage_;
  std::size_t total_ = 1;
  std::atomic<std::size_t> done_{0};
  std::atomic<int> reported_{-1};
  std::atomic<bool> cancelled_{false};
  std::chrono::steady_clock::time_point start_{};
  double cpu_start_ = 0;
  std::vector<Timing> timings_;
};

/// CPU seconds (user + system, all threads) this process has used so far.
SANSMESH_API double process_cpu_seconds();

}  // namespace sansmesh::inline v1
