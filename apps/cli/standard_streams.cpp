#include "standard_streams.h"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "parse_line.h"
#include "sansmesh/error.h"

namespace sansmesh::cli {
namespace {

constexpr const char *kIn = "/dev/stdin", *kOut = "/dev/stdout";

/// Returns true if the values of the option are files, or may be.
bool takes_files(const OptionEntry& option) { return option.is_file() || option.value_name == "INPUT"; }

/// The ending that goes without saying; empty if there is none. Descriptions of what is read name some of many.
std::string ending_by_itself(const OptionEntry& option) {
  if (!writes_file(option)) return option.endings.size() == 1 ? option.endings[0] : "";
  const std::vector<std::string> endings = option.file_endings();
  return endings.empty() ? "" : endings[0];
}

}  // namespace

bool writes_file(const OptionEntry& option) {
  constexpr std::string_view names[] = {"--output",   "--preview",  "--animation",
                                        "--pictures", "--energies", "--save-transfer"};
  return std::find(std::begin(names), std::end(names), option.name()) != std::end(names) ||
         option.name().ends_with("-output");
}

void name_standard_streams(CommandLine& command) {
  int in = 0, out = 0;
  for (const auto& option : command.options()) {
    if (!takes_files(*option)) continue;
    for (std::string& value : option->values) {
      if (value != "-" && !value.starts_with("-.")) continue;
      const bool written = writes_file(*option);
      if (++(written ? out : in) > 1)
        throw UsageError(command, fmt::format("only one file can be standard {}", written ? "output" : "input"));
      const std::string ending = value == "-" ? ending_by_itself(*option) : value.substr(1);
      if (written && ending.empty())
        throw UsageError(command, fmt::format("{} - needs the ending of a format, as -.ply", option->typed));
      value = (written ? kOut : kIn) + ending;
    }
  }
}

}  // namespace sansmesh::cli
