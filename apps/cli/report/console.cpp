#include "cli/report/console.h"

#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <exception>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "cli/line/command_line.h"
#include "cli/line/flags.h"
#include "cli/report/standard_output.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/error.h"

namespace sansmesh::cli {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

constexpr double kBarDelay = 0.3;  // seconds of work before a bar is worth drawing

}  // namespace

/// The JSON of all that was told until now.
struct Console::Results {
  Json told, messages = Json::array();
  Json files = Json::array();  ///< of several files, one after the other
};

Console::Console(const ConsoleOptions& options, const CommandLine& command)
    : options_(options),
      command_(command),
      results_(std::make_unique<Results>()),
      started_(now()),
      progress_([this](const std::string& stage, double fraction) { draw(stage, fraction); }),
      interruptible_(progress_),
      listening_(progress_) {
  const char* kind = std::getenv("TERM");
  terminal_ = !options.quiet && isatty(STDERR_FILENO) && kind && std::string(kind) != "dumb";
}

Console::~Console() { clear(); }

void Console::finish() {
  progress_.check();
  progress_.finish();
  finishing_ = true;
  outputs_.commit();
  show(std::exchange(said_, {}));
  show_json();
  print_timings();
  finish_out();
}

std::string Console::rescue_frames() {
  const std::size_t kept = outputs_.waiting();
  if (!keeps_frames_ || kept == 0) return {};
  // After a failure of finish() the file of the error is one of the frames.
  const std::string files = finishing_ ? counted(kept, "other file") : counted(kept, "file") + " before it";
  try {
    outputs_.commit();
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception& error) {
    return fmt::format("; {} cannot be kept: {}", files, error.what());
  }
  return fmt::format("; {} {} kept", files, kept == 1 ? "is" : "are");
}

/// Other words would spoil standard output that is a file of the command.
void Console::show(const std::string& text) {
  if (text.empty()) return;
  clear();
  if (outputs_.used_standard_output())
    print_err(text);
  else if (outputs_.waiting() > 0 || !said_.empty())
    said_ += text;
  else
    print_out(text);
}

void Console::say(const std::string& line) {
  if (says()) show(line + "\n");
}

void Console::say(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) say(in_flags(line));
}

void Console::say_of(const std::string& name, std::vector<std::string> lines) {
  lines.at(0) = name + ": " + lines[0];
  say(lines);
}

void Console::say(const std::string& title, const std::string& text, int width) { say(titled(title, text, width)); }

void Console::check_announced(const ToldReport& told) const {
  for (const ToldReport& announced : command_.told())
    if (announced.key == told.key && announced.schema == told.schema && announced.list == told.list) return;
  throw std::logic_error("no report is announced under the key " + std::string(told.key));
}

void Console::tell(const ToldReport& told, const void* report) {
  progress_.finish();  // what is told has been made
  check_announced(told);
  if (!options_.json) return;
  if (told.list)
    push_report(results_->told, told.key, *told.schema, report);
  else
    put_report(results_->told, told.key, *told.schema, report);
}

void Console::tell_value_as(std::string_view key, const ReportValue& value) {
  check_announced({key, nullptr});
  put_value(results_->told, key, value);
}

void Console::begin_list(const ToldReport& told) {
  check_announced(told);
  put_list(results_->told, told.key);
}

void Console::end_result() { results_->files.push_back(std::exchange(results_->told, Json())); }

void Console::fail(const std::string& file, const std::string& message) {
  clear();
  print_error(message);
  failed_ = true;
  results_->told = {{"file", file}, {"error", {{"kind", "file"}, {"text", message}}}};
  end_result();
}

void Console::show_json() {
  if (!options_.json) return;
  Json& told = results_->told;
  if (listing_) told = {{"files", std::move(results_->files)}};
  told["schema"] = kReportVersion;
  told["warnings"] = warnings_;
  told["messages"] = results_->messages;
  if (tells_stages_)
    for (const Progress::Timing& t : progress_.timings())
      told["stages"].push_back({{"stage", t.stage}, {"wall_s", t.wall_seconds}, {"cpu_s", t.cpu_seconds}});
  show(text_of(told));
}

void Console::warn(const std::string& file, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) warn_line(printable(file) + ": " + in_flags(warning));
}

void Console::note(const std::string& file, const std::vector<Note>& notes) {
  for (const Note& note : notes) {
    const bool warning = note.severity == Note::Severity::warning;
    if (warning)
      warn(note.of.empty() ? file : note.of, {note_line(note)});
    else
      say(in_flags(note_line(note)));
    results_->messages.push_back({{"code", note.code},
                                  {"severity", warning ? "warning" : "information"},
                                  {"text", in_flags(note.text)},
                                  {"remedy", in_flags(note.remedy)}});
  }
}

void Console::warn(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) warn_line(in_flags(warning));
}

void Console::warn_line(const std::string& line) {
  warnings_.push_back(line);
  if (options_.quiet) return;
  clear();
  print_err("warning: " + line + "\n");
}

std::string Console::in_flags(const std::string& message) const { return cli::in_flags(message, command_); }

void Console::print_timings() {
  if (!options_.verbose) return;
  clear();
  double wall = 0, cpu = 0;
  for (const Progress::Timing& t : progress_.timings()) {
    print_err(fmt::format("{:<24}{:8.3f} s wall{:9.3f} s CPU\n", t.stage, t.wall_seconds, t.cpu_seconds));
    wall += t.wall_seconds, cpu += t.cpu_seconds;
  }
  print_err(fmt::format("{:<24}{:8.3f} s wall{:9.3f} s CPU\n", "all", wall, cpu));
}

void Console::draw(const std::string& stage, double fraction) {
  if (!terminal_ || now() - started_ < kBarDelay) return;
  constexpr int width = 30;
  const int full = index_in<int>(fraction * width, 0, width);
  print_err(fmt::format("\r\033[K{:<24} [{:#<{}}{:<{}}] {:3.0f} %", stage, "", full, "", width - full, 100 * fraction));
  drawn_ = true;
}

void Console::clear() {
  if (!drawn_) return;
  print_err("\r\033[K");
  drawn_ = false;
}

void print_error(const std::string& message) { print_err("sansmesh: " + printable(message) + "\n"); }

}  // namespace sansmesh::cli
