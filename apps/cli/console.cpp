#include "console.h"

#include <fmt/core.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "flags.h"
#include "sansmesh/core/error.h"

namespace sansmesh::cli {
namespace {

std::atomic<Progress*> interrupted_progress{nullptr};

/// The first Ctrl-C lets the work end at its next check, so that no temporary file is left; the second kills.
void on_interrupt(int signal) {
  if (Progress* progress = interrupted_progress.load()) progress->cancel();
  std::signal(signal, SIG_DFL);
}

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

constexpr double kBarDelay = 0.3;  // seconds of work before a bar is worth drawing

}  // namespace

Console::Console(const ConsoleOptions& options, const CommandLine& command)
    : options_(options),
      command_(command),
      started_(now()),
      progress_([this](const std::string& stage, double fraction) { draw(stage, fraction); }) {
  const char* kind = std::getenv("TERM");
  terminal_ = !options.quiet && isatty(STDERR_FILENO) && kind && std::string(kind) != "dumb";
  interrupted_progress = &progress_;
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

Console::~Console() {
  clear();
  interrupted_progress = nullptr;
}

void Console::say(const std::string& line) {
  if (options_.json || options_.quiet) return;
  clear();
  fmt::print("{}\n", line);
}

void Console::say_json(Json json) {
  if (!options_.json) return;
  clear();
  json["warnings"] = warnings_;
  fmt::print("{}\n", json.text());
}

void Console::warn(const std::string& file, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) warn_line(printable(file) + ": " + in_flags(warning));
}

void Console::warn(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) warn_line(in_flags(warning));
}

void Console::warn_line(const std::string& line) {
  warnings_.push_back(line);
  if (options_.quiet) return;
  clear();
  fmt::print(stderr, "warning: {}\n", line);
}

std::string Console::in_flags(const std::string& message) const { return cli::in_flags(message, command_); }

void Console::print_timings() {
  if (!options_.verbose) return;
  clear();
  double wall = 0, cpu = 0;
  for (const Progress::Timing& t : progress_.timings()) {
    fmt::print(stderr, "{:<24}{:8.3f} s wall{:9.3f} s CPU\n", t.stage, t.wall_seconds, t.cpu_seconds);
    wall += t.wall_seconds, cpu += t.cpu_seconds;
  }
  fmt::print(stderr, "{:<24}{:8.3f} s wall{:9.3f} s CPU\n", "all", wall, cpu);
}

void Console::draw(const std::string& stage, double fraction) {
  if (!terminal_ || now() - started_ < kBarDelay) return;
  constexpr int width = 30;
  const int full = static_cast<int>(fraction * width);
  fmt::print(stderr, "\r\033[K{:<24} [{:#<{}}{:<{}}] {:3.0f} %", stage, "", full, "", width - full, 100 * fraction);
  std::fflush(stderr);
  drawn_ = true;
}

void Console::clear() {
  if (!drawn_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

void print_error(const std::string& message) { fmt::print(stderr, "sansmesh: {}\n", printable(message)); }

std::string length(double value) { return fmt::format("{:.4g}", value); }

}  // namespace sansmesh::cli
