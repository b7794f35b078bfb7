// What every command says, and how: results on standard output, everything else on standard error.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/report/interrupt.h"
#include "cli/report/report_json.h"
#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/io/output_batch.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"

namespace sansmesh::cli {

class CommandLine;

struct ConsoleOptions {
  bool json = false;     ///< results as one JSON object instead of lines
  bool verbose = false;  ///< time of each stage, on standard error
  bool quiet = false;    ///< no progress, no warnings; results only where they were asked for (--json)
};

class Console {
 public:
  /// `command`: the one that runs, in whose words warnings are.
  Console(const ConsoleOptions& options, const CommandLine& command);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  const ConsoleOptions& options() const { return options_; }
  /// Draws the bar where standard error is a terminal; cancelled by Ctrl-C.
  Progress& progress() { return progress_; }

  /// Frames of a motion that are written stay there if a later one fails, whatever the error: they took long.
  void keep_frames() { keeps_frames_ = true; }
  /// Puts the files of the command in their places (OutputBatch), then prints what was said of them. Called once, when
  /// all has gone well. Throws what these do, Cancelled, and errors of standard output.
  void finish();
  /// After an error, be it of finish(): frames that are to be kept are put in their places; words about that, which
  /// follow those of the error, empty if there are none. Throws Cancelled.
  std::string rescue_frames();

  /// True if what is said is printed: what takes time is only then measured for it.
  bool says() const { return !options_.json && !options_.quiet; }
  /// A result for people: printed unless --json or --quiet. Once files were written, it waits for finish().
  void say(const std::string& line);
  /// Several lines, in which options are named as in messages of the library.
  void say(const std::vector<std::string>& lines);
  /// The same of what has a name: "scan.ply: " stands before the first.
  void say_of(const std::string& name, std::vector<std::string> lines);
  /// The same with a title: "area            0.5".
  void say(const std::string& title, const std::string& text, int width = 16);
  /// A result for programs: what a report tells, under a key or beside the others. Printed with --json, once all is
  /// done, with all that was warned of (`warnings`). The stage of the progress ends. Throws std::logic_error for
  /// reports of which the command does not say that it tells them (CommandLine::tells).
  template <HasReport T>
  void tell(const T& report, std::string_view key = {}) {
    tell(ToldReport{key, &T::schema()}, &report);
  }
  /// The same of a list of reports.
  template <HasReport T>
  void tell(const std::vector<T>& reports, std::string_view key) {
    const ToldReport told{key, &T::schema(), true};
    begin_list(told);
    for (const T& report : reports) tell(told, &report);
  }
  /// The same of a value.
  template <class T>
  void tell_value(std::string_view key, const T& value) {
    tell_value_as(key, report_detail::value_of(value));
  }
  /// The time of each stage as well (`stages`), of commands whose results are not compared.
  void tell_stages() { tells_stages_ = true; }
  /// From here on results for programs are a list, `files` of one object: a command tells of several files, one after
  /// the other.
  void list_results() { listing_ = true; }
  /// Ends the results of one of these files: what was told since the last call is of it.
  void end_result();
  /// A mistake in one of several files: told as errors are, and in the list. The command goes on, and fails in the end.
  void fail(const std::string& file, const std::string& message);
  bool has_failed() const { return failed_; }
  /// Warnings until now, as they were printed, or would have been but for --quiet.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Warnings of the library name options by their fields; these are put in the words of the command.
  void warn(const std::string& file, const std::vector<std::string>& warnings);
  /// Notes of a job: warnings are printed as such, information as a result for people; all stand in the JSON
  /// (`messages`). `file` is the one that they are about unless they name one themselves.
  void note(const std::string& file, const std::vector<Note>& notes);
  /// The same of warnings that name their files themselves.
  void warn(const std::vector<std::string>& warnings);
  /// The same for what is printed in other ways.
  std::string in_flags(const std::string& message) const;

 private:
  struct Results;

  void tell(const ToldReport& told, const void* report);
  void tell_value_as(std::string_view key, const ReportValue& value);
  void begin_list(const ToldReport& told);
  void check_announced(const ToldReport& told) const;
  /// All that was told.
  void show_json();
  /// With --verbose: the table of stages.
  void print_timings();
  void warn_line(const std::string& line);
  void show(const std::string& text);
  void draw(const std::string& stage, double fraction);
  void clear();

  ConsoleOptions options_;
  const CommandLine& command_;
  std::vector<std::string> warnings_;
  std::unique_ptr<Results> results_;
  bool listing_ = false, failed_ = false;
  std::string said_;  ///< once there are files, of which it is, in their places
  bool keeps_frames_ = false;
  bool tells_stages_ = false;
  bool finishing_ = false;
  bool terminal_ = false;
  bool drawn_ = false;
  double started_ = 0;
  Progress progress_;
  InterruptibleWork interruptible_;
  CancelScope listening_;
  OutputBatch outputs_;
};

/// Reports an error as one line.
void print_error(const std::string& message);

/// A length with four significant digits.
inline std::string length(double value) { return length_words(value); }

}  // namespace sansmesh::cli
