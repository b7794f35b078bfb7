// Shell completion, generated from the table of options.
#pragma once

#include <string>

#include "cli/line/command_line.h"

namespace sansmesh::cli {

/// Scripts that complete commands, options, choices, and file names with matching endings.
std::string bash_completion(const CommandLine& root);
std::string zsh_completion(const CommandLine& root);
std::string fish_completion(const CommandLine& root);

}  // namespace sansmesh::cli
