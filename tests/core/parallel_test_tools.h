// Tools for tests of parallel loops.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "sansmesh/core/parallel.h"

namespace sansmesh::test {

/// Barrier with a time-out.
class MeetingPlace {
 public:
  explicit MeetingPlace(std::ptrdiff_t expected) : expected_(expected) {}
  /// Returns whether all threads arrived.
  bool arrive() {
    std::unique_lock lock(mutex_);
    if (++arrived_ >= expected_) all_.notify_all();
    return all_.wait_for(lock, std::chrono::seconds(10), [&] { return arrived_ >= expected_; });
  }

 private:
  std::ptrdiff_t expected_, arrived_ = 0;
  std::mutex mutex_;
  std::condition_variable all_;
};

/// Detects whether a thread enters again before leaving.
class Door {
 public:
  bool enter() const { return std::exchange(inside(), true); }
  void leave() const { inside() = false; }

 private:
  static bool& inside() {
    thread_local bool inside = false;
    return inside;
  }
};

inline void wait_in_a_loop() {
  parallel_for(0, 8, 1, [](std::size_t) { std::this_thread::sleep_for(std::chrono::microseconds(300)); });
}

}  // namespace sansmesh::test
