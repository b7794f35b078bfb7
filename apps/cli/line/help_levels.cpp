#include "cli/line/help_levels.h"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "sansmesh/schema/option_levels.h"

namespace sansmesh::cli {

void arrange_help(std::span<const Command> commands) {
  for (const Command& entry : commands) {
    const CommandLine& command = *entry.line;
    const std::string name = command.path();
    const std::vector<std::string_view> first = basic_options(name);
    for (const std::string_view option : first)
      if (!command.find("--" + std::string(option)))
        throw std::logic_error(fmt::format("{} has no option --{}", name, option));
    const std::vector<std::string_view> of_sources = source_options(name, command.has("--surface"));
    const auto among = [](const std::vector<std::string_view>& options, const OptionEntry& option) {
      return std::find(options.begin(), options.end(), option.name().substr(2)) != options.end();
    };
    for (const auto& option : command.options()) {
      if (option->positional()) continue;
      if (among(of_sources, *option)) option->group = kSourcesGroup;
      option->advanced =
          option->group == kViewGroup || option->group == kSourcesGroup || (!first.empty() && !among(first, *option));
    }
  }
}

}  // namespace sansmesh::cli
