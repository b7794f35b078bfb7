// Table of all commands, and the options that all of them have.
#pragma once

#include <vector>

#include "cli/line/command.h"

namespace sansmesh::cli {

/// Options that every command has.
struct CommonArguments {
  ConsoleOptions console;
  int threads = 0;
};

/// Declares the commands and groups of commands that apps/cli/CMakeLists.txt lists, in its order; made from that list.
std::vector<Command> own_commands(CommandLine& app);

/// Declares the commands and their options. `line` is the whole tool; it and `common` must outlive the run.
std::vector<Command> add_commands(CommandLine& line, CommonArguments& common);

}  // namespace sansmesh::cli
