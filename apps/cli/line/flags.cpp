#include "cli/line/flags.h"

#include "cli/line/command_line.h"

namespace sansmesh::cli {
namespace {

/// Flag of a field in a command; empty if it has no option.
std::string flag_of(std::string_view field, const CommandLine& command) {
  for (const auto& option : command.options())
    if (option->field == field) return option->name();
  // A flag that sets its field or, if there is none, the flag that clears it.
  for (const auto& option : command.options())
    if (option->row && option->row->kind == OptionKind::flag &&
        (option->field + " = true" == field || option->row->name == field))
      return option->name();
  for (const auto& option : command.options())
    if (option->row && !option->row->old_name.empty() && option->row->old_name == field) return option->name();
  const std::string flag = flag_of_name(field);
  return command.has(flag) ? flag : std::string();
}

/// Flag for a field, or for a field with a value.
std::string translated(std::string_view code, const CommandLine& command) {
  std::string flag = flag_of(code, command);
  if (!flag.empty()) return flag;
  constexpr std::string_view kIs = " = ";
  const std::size_t is = code.find(kIs);
  if (is != std::string_view::npos) flag = flag_of(code.substr(0, is), command);
  if (flag.empty()) return std::string(code);
  // If the flag may stand alone, the next word would not be its value.
  const OptionEntry* const option = command.find(flag);
  return flag + (option && option->implied ? "=" : " ") + std::string(code.substr(is + kIs.size()));
}

}  // namespace

std::string flag_of_name(std::string_view name) {
  std::string flag = "--";
  for (const char c : name) flag += c == '_' ? '-' : c;
  return flag;
}

std::string in_flags(const std::string& message, const CommandLine& command) {
  std::string text;
  std::size_t at = 0;
  for (;;) {
    const std::size_t opens = message.find('`', at);
    const std::size_t closes = opens == std::string::npos ? opens : message.find('`', opens + 1);
    if (closes == std::string::npos) return text + message.substr(at);
    text += message.substr(at, opens - at);
    text += translated(std::string_view(message).substr(opens + 1, closes - opens - 1), command);
    at = closes + 1;
  }
}

}  // namespace sansmesh::cli
