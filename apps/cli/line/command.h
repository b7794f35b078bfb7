// A command of the tool: its options and its action. Each command's source has a function add_NAME(app) that declares
// its options and returns it; CMakeLists.txt lists them.
#pragma once

#include <functional>
#include <string_view>

#include "cli/line/command_line.h"
#include "cli/report/console.h"
#include "sansmesh/schema/registry.h"

namespace sansmesh::cli {

struct Command {
  CommandLine* line;  ///< the subcommand with its own options; command_table.cpp adds the common ones
  /// Called once after parsing; captures its arguments. Throws errors.
  std::function<void(Console&)> run;
};

/// A command that a program adds to the tool: `static const Registered<CommandEntry> mine({"mine", add_mine});`
struct CommandEntry {
  std::string_view name;
  Command (*add)(CommandLine& app);

  static Registry<CommandEntry>& registry();
};

}  // namespace sansmesh::cli
