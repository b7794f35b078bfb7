// Help, made from the table of options.
#pragma once

#include <string>
#include <vector>

#include "cli/line/command_line.h"

namespace sansmesh::cli {

/// "sansmesh mesh [OPTIONS] input -o FILE".
std::string usage_of(const CommandLine& command);
/// About a command, or about the whole tool: what people use first, and the names of the other options; or everything.
std::string help_text(const CommandLine& command, bool all = false);
/// The options under one heading, "picture" for "Picture", "raw-files" for "Raw files"; empty if the command has no
/// such heading.
std::string help_on_group(const CommandLine& command, const std::string& word);
/// The options of views, which are the same in all commands that have them.
std::string help_on_views(const CommandLine& tool);
/// A few lines for somebody who typed a command and nothing else: usage, an example or two, where to read on.
std::string short_help(const CommandLine& command);

/// The lines of the examples in a command's footer, and the footer without them.
std::vector<std::string> examples_of(const CommandLine& command);
std::string remarks_of(const CommandLine& command);

/// The options that a command's help lists, under their headings, its own ones first and those of the whole tool last.
struct OptionGroup {
  std::string heading;
  std::vector<const OptionEntry*> options;
};
std::vector<OptionGroup> option_groups_of(const CommandLine& command);
/// "-o, --output FILE".
std::string option_words(const OptionEntry& option);

}  // namespace sansmesh::cli
