// Parsing of the command line by the table of options.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "cli/line/command_line.h"

namespace sansmesh::cli {

/// Error in the command line. what() is one line that names the option as typed, and its value.
struct UsageError : std::runtime_error {
  UsageError(const CommandLine& at, const std::string& what, bool nothing_typed = false)
      : std::runtime_error(what), command(&at), bare(nothing_typed) {}
  const CommandLine* command;  ///< the command, as far as parsed
  bool bare;                   ///< nothing was typed but the command
};

struct ParsedLine {
  enum class Action { run, help, help_all, version };
  Action action = Action::run;
  CommandLine* command = nullptr;  ///< the command to run, or to show help for
};

/// Finds the command, passes values to all options in order of declaration, and records how they were typed. Global
/// options may precede the command. Throws UsageError.
ParsedLine parse_line(CommandLine& root, const std::vector<std::string>& words);

/// The command or group named by the words: {"volume", "probe"}. Throws UsageError for unknown words.
const CommandLine& command_of(const CommandLine& root, const std::vector<std::string>& words);

/// A message of the library with flags as typed instead of field names. If the message states the requirement but not
/// the value, the value is added.
std::string with_typed_values(const std::string& message, const CommandLine& command);

}  // namespace sansmesh::cli
