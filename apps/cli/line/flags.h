// Converts field names in messages of the library to flags of the command line.
#pragma once

#include <string>
#include <string_view>

namespace sansmesh::cli {

class CommandLine;

/// Flag of a name: --max-degree for `max_degree`.
std::string flag_of_name(std::string_view name);

/// A message in which options are named between grave accents (sansmesh/error.h), in the words of a command:
/// Replaces `max_depth` by --depth, `enhance = false` by --no-enhance, `components = all` by --components all. Names
/// without an option in the command stay, without the accents.
std::string in_flags(const std::string& message, const CommandLine& command);

}  // namespace sansmesh::cli
