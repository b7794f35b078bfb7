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

/// Stages are entered in sequence by the algorithm (`begin`), advanced by its workers (`advance`), and observed by
/// the caller through the callback. Wall time of each finished stage is kept (`timings`).
class SANSMESH_API Progress {
 public:
  /// Called with the stage's name and the fraction done in [0, 1], from one thread at a time, at most ~100 times a
  /// stage.
  using Callback = std::function<void(const std::string& stage, double fraction)>;

  Progress() = default;
  explicit Progress(Callback callback) : callback_(std::move(callback)) {}

  /// Ends the current stage and starts another of `total` work units.
  void begin(const std::string& stage, std::size_t total = 1);
  /// Reports `units` of work done; throws Cancelled after cancel().
  void advance(std::size_t units = 1);
  /// Ends the current stage.
  void finish();

  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  void check() const {
    if (cancelled_.load(std::memory_order_relaxed)) throw Cancelled();
  }

  struct Timing {
    std::string stage;
    double wall_seconds = 0;
    double cpu_seconds = 0;
  };
  /// Finished stages in the order they ran.
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
