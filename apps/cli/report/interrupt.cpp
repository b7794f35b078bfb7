#include "cli/report/interrupt.h"

#include <errno.h>
#include <fmt/core.h>
#include <semaphore.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <system_error>
#include <thread>

#include "cli/report/console.h"
#include "cli/report/standard_output.h"
#include "sansmesh/io/output_batch.h"

namespace sansmesh::cli {
namespace {

constexpr long kGrace = 150'000'000;  // nanoseconds

sem_t signals;
std::atomic<int> signal_count{0};

/// State shared by the work and the thread that waits for signals.
struct Interrupts {
  std::mutex mutex;
  Progress* work = nullptr;
  bool came = false;
  bool over = false;  ///< the program reports its end itself
};
Interrupts& interrupts() {
  static auto* const i = new Interrupts;  // never destroyed: the thread outlives main()
  return *i;
}

void on_signal(int signal) {
  const int error = errno;
  if (++signal_count > 1) std::signal(signal, SIG_DFL);
  ::sem_post(&signals);
  errno = error;
}

/// Waits for a signal, at most until `until`.
void wait_for_signal(const timespec* until) {
  while ((until ? ::sem_timedwait(&signals, until) : ::sem_wait(&signals)) != 0 && errno == EINTR) {
  }
}

void end_program() {
  const std::vector<std::string> written = abandon_outputs();
  {
    const std::lock_guard lock(interrupts().mutex);
    if (!interrupts().over) {
      if (::isatty(STDERR_FILENO)) print_err("\r\033[K");
      print_error(interrupted_words(written));
    }
  }
  std::_Exit(kInterrupted);
}

void watch_signals() {
  wait_for_signal(nullptr);
  {
    const std::lock_guard lock(interrupts().mutex);
    interrupts().came = true;
    if (interrupts().over) return;
    if (interrupts().work) interrupts().work->cancel();
  }
  timespec until{};
  ::clock_gettime(CLOCK_REALTIME, &until);
  until.tv_nsec += kGrace;
  until.tv_sec += until.tv_nsec / 1'000'000'000;
  until.tv_nsec %= 1'000'000'000;
  wait_for_signal(&until);
  end_program();
}

/// Returns false if no thread can be started.
bool start_watching() {
  // Signals are delivered to the other threads; this one only waits.
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  bool started = true;
  try {
    std::thread(watch_signals).detach();
  } catch (const std::system_error&) {
    started = false;
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return started;
}

}  // namespace

void listen_for_interrupts() {
  ::sem_init(&signals, 0, 0);
  interrupts();
  if (!start_watching()) return;
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction old {};
    ::sigaction(signal, nullptr, &old);
    // nohup, and scripts that run the program in the background
    if (signal != SIGTERM && old.sa_handler == SIG_IGN) continue;
    ::sigaction(signal, &action, nullptr);
  }
}

InterruptibleWork::InterruptibleWork(Progress& progress) {
  const std::lock_guard lock(interrupts().mutex);
  interrupts().work = &progress;
  if (interrupts().came) progress.cancel();
}

InterruptibleWork::~InterruptibleWork() {
  const std::lock_guard lock(interrupts().mutex);
  interrupts().work = nullptr;
}

void end_of_interrupts() {
  const std::lock_guard lock(interrupts().mutex);
  interrupts().over = true;
}

std::string interrupted_words(const std::vector<std::string>& written) {
  if (written.empty()) return "interrupted, nothing was written";
  if (written.size() == 1) return fmt::format("interrupted, but {} is written", written[0]);
  return fmt::format("interrupted, but {} files are written, {} to {}", written.size(), written.front(),
                     written.back());
}

}  // namespace sansmesh::cli
