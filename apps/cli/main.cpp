// Main function: runs a command and returns its exit code.
#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/line/command_table.h"
#include "cli/line/error_words.h"
#include "cli/line/flags.h"
#include "cli/line/help_text.h"
#include "cli/line/parse_line.h"
#include "cli/line/suggestions.h"
#include "cli/report/interrupt.h"
#include "cli/report/json.h"
#include "cli/report/standard_output.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/io/output_batch.h"

namespace sansmesh::cli {
namespace {

constexpr int kFailed = 1;  // error in a file or its data
constexpr int kUsage = 2;   // error in the command line

/// The command of an entry without subcommands.
const Command& command_of_line(const std::vector<Command>& commands, const CommandLine& line) {
  return *std::find_if(commands.begin(), commands.end(), [&](const Command& c) { return c.line == &line; });
}

/// The command was interrupted; these files were written before.
struct Interrupted {
  std::vector<std::string> written;
};

void warn_of_old_names(const CommandLine& line, Console& console) {
  constexpr const char* kOld = "{} is now called {}, and will be removed in the next version";
  if (line.called_by_old_name) console.warn({fmt::format(kOld, line.old_name(), line.name())});
  for (const auto& option : line.options())
    if (std::find(option->old_names.begin(), option->old_names.end(), option->typed) != option->old_names.end())
      console.warn({fmt::format(kOld, option->typed, option->name())});
}

/// Runs a command and returns its exit code. If it fails, `kept` receives text about files that are kept, which follows
/// the error message.
int run(const Command& command, const CommonArguments& common, std::string& kept) {
  const ThreadScope threads(common.threads);
  Console console(common.console, *command.line);
  try {
    try {
      warn_of_old_names(*command.line, console);
      command.run(console);
      console.finish();
    } catch (const Cancelled&) {
      throw;
    } catch (...) {
      kept = console.rescue_frames();
      throw;
    }
  } catch (const Cancelled&) {
    throw Interrupted{abandon_outputs()};
  }
  end_of_interrupts();
  return console.has_failed() ? kFailed : 0;
}

/// Prints the error in one line, or a short help if only a command was typed.
void report(const UsageError& error) {
  if (error.bare) {
    print_err(short_help(*error.command));
    return;
  }
  print_error(fmt::format("{} (see sansmesh help{}{})", error.what(), error.command->parent() ? " " : "",
                          error.command->path()));
}

/// Prints an error as text and, with --json, as data; `kind` is argument, file, data, interrupted or other.
class Failure {
 public:
  Failure(const char* kind, std::string message) : message_(std::move(message)) {
    error_["kind"] = kind;
    error_["text"] = message_;
  }
  Failure& with(const char* key, const std::string& value) {
    if (!value.empty()) error_[key] = value;
    return *this;
  }
  int print(bool json, int code) {
    print_error(message_);
    if (json) {
      error_["exit_code"] = code;
      try {
        print_out(text_of({{"schema", kReportVersion}, {"error", error_}}));
        finish_out();
      } catch (const BrokenPipe&) {
        end_by_broken_pipe();
      } catch (const FileError&) {  // the first error has been printed
        return code;
      }
    }
    return code;
  }

 private:
  std::string message_;
  Json error_;
};

int run_line(int argc, char** argv) {
  CommonArguments common;
  CommandLine line("Surfaces and volumes straight from samples.", "sansmesh");
  const std::vector<Command> commands = add_commands(line, common);
  const CommandLine* chosen = &line;
  std::string kept;
  try {
    const ParsedLine parsed = parse_line(line, {argv + 1, argv + argc});
    chosen = parsed.command;
    if (parsed.action == ParsedLine::Action::run) {
      return run(command_of_line(commands, *chosen), common, kept);
    } else {
      print_out(parsed.action == ParsedLine::Action::version
                    ? "sansmesh " SANSMESH_VERSION "\n"
                    : help_text(*chosen, parsed.action == ParsedLine::Action::help_all));
      finish_out();
    }
    return 0;
  } catch (const UsageError& error) {
    report(error);
    return kUsage;
  } catch (const BrokenPipe&) {
    end_by_broken_pipe();
  } catch (const Interrupted& interrupted) {
    end_of_interrupts();
    return Failure("interrupted", interrupted_words(interrupted.written)).print(common.console.json, kInterrupted);
  } catch (const ArgumentError& error) {
    const std::string message = with_typed_values(in_flags(error.what(), *chosen), *chosen);
    const ArgumentFault& fault = error.fault();
    return Failure("argument", message + did_you_mean_listed(message) + kept)
        .with("field", fault.field)
        .with("value", fault.value)
        .with("allowed", fault.allowed)
        .print(common.console.json, kUsage);
  } catch (const FileError& error) {
    return Failure("file", words_of_file_error(error, *chosen) + kept)
        .with("file", error.file())
        .print(common.console.json, kFailed);
  } catch (const DataError& error) {
    return Failure("data", in_flags(error.what(), *chosen) + kept).print(common.console.json, kFailed);
  } catch (const std::exception& error) {
    return Failure("other", in_flags(words_of_error(error), *chosen) + kept).print(common.console.json, kFailed);
  }
}

}  // namespace
}  // namespace sansmesh::cli

int main(int argc, char** argv) {
  sansmesh::cli::prepare_standard_output();
  sansmesh::cli::listen_for_interrupts();
  return sansmesh::cli::run_line(argc, argv);
}
