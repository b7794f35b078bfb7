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

/// Functions that add the commands listed in apps/cli/CMakeLists.txt, in that order; generated from that list.
std::vector<Command (*)(CommandLine& app)> own_commands();

/// Declares the commands and their options. `line` is the whole tool; it and `common` must outlive the run.
std::vector<Command> add_commands(CommandLine& line, CommonArguments& common);

}  // namespace sansmesh::cli
