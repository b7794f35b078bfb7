#include "sansmesh/progress.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <mutex>
#include <utility>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

double process_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Progress::State {
  Callback callback;
  std::mutex mutex;
  std::string stage;
  std::size_t total = 1;
  std::atomic<std::size_t> done{0};
  std::atomic<int> reported{-1};
  std::atomic<bool> cancelled{false};
  std::chrono::steady_clock::time_point start{};
  double cpu_start = 0;
  std::vector<Timing> timings;
};

Progress::Progress() : Progress(Callback()) {}

Progress::Progress(Callback callback) : state_(std::make_unique<State>()) { state_->callback = std::move(callback); }

Progress::~Progress() = default;

void Progress::cancel() { state_->cancelled.store(true, std::memory_order_relaxed); }

void Progress::check() const {
  if (state_->cancelled.load(std::memory_order_relaxed) || wants_stop()) throw Cancelled();
}

const std::vector<Progress::Timing>& Progress::timings() const { return state_->timings; }

void Progress::report(const std::string& stage, double fraction) {
  if (state_->callback) state_->callback(stage, fraction);
}

bool Progress::wants_stop() const { return false; }

void Progress::begin(const std::string& stage, std::size_t total) {
  finish();
  check();
  State& s = *state_;
  const std::scoped_lock lock(s.mutex);
  s.stage = stage;
  s.total = std::max<std::size_t>(total, 1);
  s.done = 0;
  s.reported = -1;
  s.start = std::chrono::steady_clock::now();
  s.cpu_start = process_cpu_seconds();
  report(s.stage, 0.0);
}

void Progress::advance(std::size_t units) {
  check();
  State& s = *state_;
  const std::size_t done = s.done.fetch_add(units) + units;
  const int percent = static_cast<int>(100 * std::min(done, s.total) / s.total);
  if (percent <= s.reported.load()) return;
  const std::scoped_lock lock(s.mutex);
  if (percent <= s.reported.load()) return;
  s.reported = percent;
  report(s.stage, percent / 100.0);
}

void Progress::finish() {
  State& s = *state_;
  const std::scoped_lock lock(s.mutex);
  if (s.stage.empty()) return;
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - s.start).count();
  s.timings.push_back({s.stage, wall, process_cpu_seconds() - s.cpu_start});
  report(s.stage, 1.0);
  s.stage.clear();
}

}  // namespace sansmesh::inline v1
