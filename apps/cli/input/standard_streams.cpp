#include "cli/input/standard_streams.h"

#include <fmt/core.h>

#include "cli/line/parse_line.h"
#include "sansmesh/core/read_text.h"
#include "sansmesh/error.h"

namespace sansmesh::cli {
namespace {

/// Default ending: the only one of the option, or the first one for output; otherwise empty.
std::string ending_by_itself(const OptionEntry& option, bool written) {
  return option.endings.size() == 1 || (written && !option.endings.empty()) ? option.endings[0] : "";
}

}  // namespace

void name_standard_streams(CommandLine& command) {
  int in = 0, out = 0;
  for (const auto& option : command.options()) {
    if (!option->is_file()) continue;
    for (std::string& value : option->values) {
      if (value != "-" && !value.starts_with("-.")) continue;
      const bool written = option->file == OptionEntry::File::written;
      if (++(written ? out : in) > 1)
        throw UsageError(command, fmt::format("only one file can be standard {}", written ? "output" : "input"));
      const std::string ending = value == "-" ? ending_by_itself(*option, written) : value.substr(1);
      if (written && ending.empty())
        throw UsageError(command, fmt::format("{} - needs the ending of a format, as -.ply", option->typed));
      value = std::string(written ? kStandardOutput : kStandardInput) + ending;
    }
  }
}

}  // namespace sansmesh::cli
