// Ctrl-C and its like: SIGINT, SIGTERM, SIGHUP.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/progress.h"

namespace sansmesh::cli {

constexpr int kInterrupted = 130;  ///< exit code, as shells have it for Ctrl-C

/// From now on the first signal cancels the work, and ends the program if that has not ended by itself a sixth of a
/// second later (in a reader of another library, say); the second ends it at once. Either way no file is left half
/// written. The third is the system's. SIGINT and SIGHUP that whoever started the program ignores stay ignored (nohup,
/// background jobs of scripts). Where no thread can be had for listening, signals do what they do to any program.
void listen_for_interrupts();

/// While it lives, this is the work that is cancelled.
class InterruptibleWork {
 public:
  explicit InterruptibleWork(Progress& progress);
  ~InterruptibleWork();
  InterruptibleWork(const InterruptibleWork&) = delete;
  InterruptibleWork& operator=(const InterruptibleWork&) = delete;
};

/// The program says itself how it ended: from here on a first signal does nothing.
void end_of_interrupts();

/// One line for somebody who interrupted; `written`: files that are in place all the same.
std::string interrupted_words(const std::vector<std::string>& written);

}  // namespace sansmesh::cli
