// Output of commands: results to standard output, everything else to standard error.
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
  bool json = false;     ///< results as one JSON object instead of text
  bool verbose = false;  ///< time of each stage, on standard error
  bool quiet = false;    ///< no progress, no warnings; results only with --json
};

class Console {
 public:
  /// `command`: the running command, whose flags messages use.
  Console(const ConsoleOptions& options, const CommandLine& command);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  const ConsoleOptions& options() const { return options_; }
  /// Progress bar, shown if standard error is a terminal; Ctrl-C cancels it.
  Progress& progress() { return progress_; }

  /// Keeps written frames of a motion if a later one fails, since they took long.
  void keep_frames() { keeps_frames_ = true; }
  /// Moves the output files of the command into place (OutputBatch), then prints the results. Called once after
  /// success. Throws what these throw, Cancelled, and errors of standard output.
  void finish();
  /// After an error (also of finish()): moves frames that are to be kept into place. Returns text that follows the
  /// error message; may be empty. Throws Cancelled.
  std::string rescue_frames();

  /// True if text results are printed. If not, commands may skip measures that only serve them.
  bool prints_text() const { return !options_.json && !options_.quiet; }
  /// Prints a result as text unless --json or --quiet. After files were written, it waits for finish().
  void print(const std::string& line);
  /// Prints lines in which options have their library names.
  void print(const std::vector<std::string>& lines);
  /// The same with a name before the first line: "scan.ply: ".
  void print_named(const std::string& name, std::vector<std::string> lines);
  /// The same with a title: "area            0.5".
  void print(const std::string& title, const std::string& text, int width = 16);
  /// Adds a report to the JSON result, under a key or at the top level. --json prints it at the end, with all warnings
  /// (`warnings`). Ends the stage of the progress. Throws std::logic_error for reports that the command did not declare
  /// (CommandLine::announce).
  template <HasReport T>
  void report(const T& report, std::string_view key = {}) {
    put_entry({key, &T::schema()}, &report);
  }
  /// Adds a list of reports.
  template <HasReport T>
  void report(const std::vector<T>& reports, std::string_view key) {
    const AnnouncedReport entry{key, &T::schema(), true};
    begin_list(entry);
    for (const T& report : reports) put_entry(entry, &report);
  }
  /// Adds a single value.
  template <class T>
  void report_value(std::string_view key, const T& value) {
    report_single_value(key, report_detail::value_of(value));
  }
  /// Adds the time of each stage (`stages`), for commands whose results are not compared.
  void report_stages() { reports_stages_ = true; }
  /// From here on, JSON results form a list `files` with one object per input file.
  void list_results() { listing_ = true; }
  /// Ends the object of one file: it has all reports since the last call.
  void end_result();
  /// Reports an error of one of several files, also in the list. The command continues and fails at the end.
  void fail(const std::string& file, const std::string& message);
  bool has_failed() const { return failed_; }
  /// Warnings so far, as printed or suppressed by --quiet.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Warnings of the library, whose field names are replaced by flags.
  void warn(const std::string& file, const std::vector<std::string>& warnings);
  /// Notes of a job: warnings are printed as such, information as a text result; JSON has all of them (`messages`).
  /// `file` is their subject unless they name one.
  void note(const std::string& file, const std::vector<Note>& notes);
  /// Warnings that name their files themselves.
  void warn(const std::vector<std::string>& warnings);
  /// A message with flags instead of field names.
  std::string in_flags(const std::string& message) const;

 private:
  struct Results;

  void put_entry(const AnnouncedReport& entry, const void* report);
  void report_single_value(std::string_view key, const ReportValue& value);
  void begin_list(const AnnouncedReport& entry);
  void check_announced(const AnnouncedReport& entry) const;
  /// Prints all reports.
  void show_json();
  /// Prints the table of stages (--verbose).
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
  std::string waiting_text_;  ///< text that waits until the files are in place
  bool keeps_frames_ = false;
  bool reports_stages_ = false;
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

/// Formats a length with four significant digits.
inline std::string length(double value) { return length_words(value); }

}  // namespace sansmesh::cli
