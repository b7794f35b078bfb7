// What the command line calls the options that messages of the library name by their fields.
#pragma once

#include <string>
#include <string_view>

namespace sansmesh::cli {

class CommandLine;

/// The flag of a name: `max_degree` has --max-degree.
std::string flag_of_name(std::string_view name);

/// A message in which options are named between grave accents (sansmesh/error.h), in the words of a command:
/// `max_depth` becomes --depth, `enhance = false` --no-enhance, `components = all` --components all. Names for which
/// the command has no option stay as they are, without the accents.
std::string in_flags(const std::string& message, const CommandLine& command);

}  // namespace sansmesh::cli
