// Help, generated from the table of options.
#pragma once

#include <string>
#include <vector>

#include "cli/line/command_line.h"

namespace sansmesh::cli {

/// "sansmesh mesh [OPTIONS] input -o FILE".
std::string usage_of(const CommandLine& command);
/// Help on a command or the whole tool: basic options and the names of the others, or everything.
std::string help_text(const CommandLine& command, bool all = false);
/// Options under one heading, "picture" for "Picture", "raw-files" for "Raw files"; empty if the command has no such
/// heading.
std::string help_on_group(const CommandLine& command, const std::string& word);
/// Options of views, which are the same in all commands with pictures.
std::string help_on_views(const CommandLine& tool);
/// Short text for a command typed without arguments: usage, one or two examples, further reading.
std::string short_help(const CommandLine& command);

/// Example lines of a command's footer, and the footer without them.
std::vector<std::string> examples_of(const CommandLine& command);
std::string remarks_of(const CommandLine& command);

/// Options in a command's help, by heading, its own first and the global ones last.
struct OptionGroup {
  std::string heading;
  std::vector<const OptionEntry*> options;
};
std::vector<OptionGroup> option_groups_of(const CommandLine& command);
/// "-o, --output FILE".
std::string option_words(const OptionEntry& option);

}  // namespace sansmesh::cli
