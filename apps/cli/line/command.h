// A command of the tool: how it is spelled, and what happens when it was chosen. Each command's source has a function
// add_NAME(app) that declares its options and returns it; CMakeLists.txt lists them.
#pragma once

#include <functional>
#include <string_view>

#include "cli/line/command_line.h"
#include "cli/report/console.h"
#include "sansmesh/schema/registry.h"

namespace sansmesh::cli {

struct Command {
  CommandLine* line;  ///< the subcommand, with its own options; those of every command are added by command_table.cpp
  /// Called once after parsing. Its arguments live in what it has captured. Errors are thrown.
  std::function<void(Console&)> run;
};

/// A command that a program adds to those of the tool: `static const Registered<CommandEntry> mine({"mine",
/// add_mine});`
struct CommandEntry {
  std::string_view name;
  Command (*add)(CommandLine& app);

  static Registry<CommandEntry>& registry();
};

}  // namespace sansmesh::cli
