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

constexpr double kBarDelay = 0.3;  // seconds of work before the bar is drawn

}  // namespace

/// JSON of all reports so far.
struct Console::Results {
  Json json, messages = Json::array();
  Json files = Json::array();  ///< one object per input file
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
  show(std::exchange(waiting_text_, {}));
  show_json();
  print_timings();
  finish_out();
}

std::string Console::rescue_frames() {
  const std::size_t kept = outputs_.waiting();
  if (!keeps_frames_ || kept == 0) return {};
  // After a failure of finish(), the file in the error is one of the frames.
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

/// If the command writes a file to standard output, text is printed to standard error.
void Console::show(const std::string& text) {
  if (text.empty()) return;
  clear();
  if (outputs_.used_standard_output())
    print_err(text);
  else if (outputs_.waiting() > 0 || !waiting_text_.empty())
    waiting_text_ += text;
  else
    print_out(text);
}

void Console::print(const std::string& line) {
  if (prints_text()) show(line + "\n");
}

void Console::print(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) print(in_flags(line));
}

void Console::print_named(const std::string& name, std::vector<std::string> lines) {
  lines.at(0) = name + ": " + lines[0];
  print(lines);
}

void Console::print(const std::string& title, const std::string& text, int width) { print(titled(title, text, width)); }

void Console::check_announced(const AnnouncedReport& entry) const {
  for (const AnnouncedReport& announced : command_.announced())
    if (announced.key == entry.key && announced.schema == entry.schema && announced.list == entry.list) return;
  throw std::logic_error("no report is announced under the key " + std::string(entry.key));
}

void Console::put_entry(const AnnouncedReport& entry, const void* report) {
  progress_.finish();  // the stage has ended
  check_announced(entry);
  if (!options_.json) return;
  if (entry.list)
    push_report(results_->json, entry.key, *entry.schema, report);
  else
    put_report(results_->json, entry.key, *entry.schema, report);
}

void Console::report_single_value(std::string_view key, const ReportValue& value) {
  check_announced({key, nullptr});
  put_value(results_->json, key, value);
}

void Console::begin_list(const AnnouncedReport& entry) {
  check_announced(entry);
  put_list(results_->json, entry.key);
}

void Console::end_result() { results_->files.push_back(std::exchange(results_->json, Json())); }

void Console::fail(const std::string& file, const std::string& message) {
  clear();
  print_error(message);
  failed_ = true;
  results_->json = {{"file", file}, {"error", {{"kind", "file"}, {"text", message}}}};
  end_result();
}

void Console::show_json() {
  if (!options_.json) return;
  Json& json = results_->json;
  if (listing_) json = {{"files", std::move(results_->files)}};
  json["schema"] = kReportVersion;
  json["warnings"] = warnings_;
  json["messages"] = results_->messages;
  if (reports_stages_)
    for (const Progress::Timing& t : progress_.timings())
      json["stages"].push_back({{"stage", t.stage}, {"wall_s", t.wall_seconds}, {"cpu_s", t.cpu_seconds}});
  show(text_of(json));
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
      print(in_flags(note_line(note)));
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
