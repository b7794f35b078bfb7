#include "sansmesh/progress.h"

#include <algorithm>
#include <ctime>

namespace sansmesh::inline v1 {

double process_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void Progress::begin(const std::string& stage, std::size_t total) {
  finish();
  check();
  const std::scoped_lock lock(mutex_);
  stage_ = stage;
  total_ = std::max<std::size_t>(total, 1);
  done_ = 0;
  reported_ = -1;
  start_ = std::chrono::steady_clock::now();
  cpu_start_ = process_cpu_seconds();
  if (callback_) callback_(stage_, 0.0);
}

void Progress::advance(std::size_t units) {
  check();
  const std::size_t done = done_.fetch_add(units) + units;
  if (!callback_) return;
  const int percent = static_cast<int>(100 * std::min(done, total_) / total_);
  if (percent <= reported_.load()) return;
  const std::scoped_lock lock(mutex_);
  if (percent <= reported_.load()) return;
  reported_ = percent;
  callback_(stage_, percent / 100.0);
}

void Progress::finish() {
  const std::scoped_lock lock(mutex_);
  if (stage_.empty()) return;
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  timings_.push_back({stage_, wall, process_cpu_seconds() - cpu_start_});
  if (callback_) callback_(stage_, 1.0);
  stage_.clear();
}

}  // namespace sansmesh::inline v1
