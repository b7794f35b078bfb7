// Handling of Ctrl-C and similar signals: SIGINT, SIGTERM, SIGHUP.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/progress.h"

namespace sansmesh::cli {

constexpr int kInterrupted = 130;  ///< exit code, as shells use for Ctrl-C

/// Starts to listen. The first signal cancels the work; if the program has not ended a sixth of a second later (in a
/// reader of another library, for example), it is terminated. The second signal terminates it at once. Neither leaves a
/// partial file. The third has the system's default effect. SIGINT and SIGHUP stay ignored if the parent process
/// ignores them (nohup, background jobs of scripts). If no listening thread can be started, signals have their default
/// effect.
void listen_for_interrupts();

/// Marks this work as the one to cancel during its lifetime.
class InterruptibleWork {
 public:
  explicit InterruptibleWork(Progress& progress);
  ~InterruptibleWork();
  InterruptibleWork(const InterruptibleWork&) = delete;
  InterruptibleWork& operator=(const InterruptibleWork&) = delete;
};

/// The program reports its end itself: from here on a first signal has no effect.
void end_of_interrupts();

/// One line after an interruption; `written`: files that are complete.
std::string interrupted_words(const std::vector<std::string>& written);

}  // namespace sansmesh::cli
