// The words of the command line, by the table of options.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "cli/line/command_line.h"

namespace sansmesh::cli {

/// The command line is at fault. what() is one line that names the option as it was typed, and its value.
struct UsageError : std::runtime_error {
  UsageError(const CommandLine& at, const std::string& what, bool nothing_typed = false)
      : std::runtime_error(what), command(&at), bare(nothing_typed) {}
  const CommandLine* command;  ///< as far as it could be told
  bool bare;                   ///< nothing was said but the command
};

struct ParsedLine {
  enum class Wish { run, help, help_all, version };
  Wish wish = Wish::run;
  CommandLine* command = nullptr;  ///< the one to run, or whose help is wanted
};

/// Finds the command, hands all options their values, in the order in which they were declared, and remembers how they
/// were typed. Options of the whole tool may stand before the command as well. Throws UsageError.
ParsedLine parse_line(CommandLine& root, const std::vector<std::string>& words);

/// The command that words name, or as much of it as there is: {"volume", "probe"}. Throws UsageError for words that are
/// no command.
const CommandLine& command_of(const CommandLine& root, const std::vector<std::string>& words);

/// A message of the library in which the command's options have their flags: of one that was given the name as it was
/// typed; and if the message says what that must be but not what it was, that is added.
std::string with_typed_values(const std::string& message, const CommandLine& command);

}  // namespace sansmesh::cli
