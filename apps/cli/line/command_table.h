// The table of all commands, and the options that all of them have.
#pragma once

#include <vector>

#include "cli/line/command.h"

namespace sansmesh::cli {

/// Options that every command has.
struct CommonArguments {
  ConsoleOptions console;
  int threads = 0;
};

/// Functions that add the commands which apps/cli/CMakeLists.txt lists, in its order; made from that list.
std::vector<Command (*)(CommandLine& app)> own_commands();

/// Declares the commands and their options. `line` is the whole tool; it and `common` live until a command has run.
std::vector<Command> add_commands(CommandLine& line, CommonArguments& common);

}  // namespace sansmesh::cli
