#include "cli/line/help_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "cli/line/help_levels.h"
#include "sansmesh/core/option_text.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kWidth = 110, kColumn = 28;
constexpr std::string_view kExamplesHeading = "Examples:\n";

/// Number of UTF-8 characters.
std::size_t shown_width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

/// Words on the left, and their explanation on the right, wrapped between words.
std::string entry_lines(const std::string& left, const std::string& right) {
  std::string text = "  " + left;
  std::size_t at = shown_width(text);
  if (right.empty()) return text + "\n";
  if (at + 1 > kColumn) text += "\n", at = 0;
  bool first = true;
  for (const std::string& word : parts_between(right, ' ')) {
    if (!first && at + 1 + shown_width(word) > kWidth) text += "\n", at = 0;
    if (at < kColumn)
      text += std::string(kColumn - at, ' '), at = kColumn;
    else
      text += ' ', ++at;
    text += word, at += shown_width(word), first = false;
  }
  return text + "\n";
}

std::string positional_words(const OptionEntry& option) {
  const std::string name = option.several ? option.name() + "..." : option.name();
  return option.required ? name : "[" + name + "]";
}

}  // namespace

std::string option_words(const OptionEntry& o) {
  std::string text = fmt::format("{}", fmt::join(o.names, ", "));
  if (o.positional()) return o.several ? text + " ..." : text;
  if (o.kind == OptionEntry::Kind::flag) return text;
  return text + (o.implied ? " [" + o.value_name + "]" : " " + o.value_name);
}

std::string usage_of(const CommandLine& command) {
  std::string text = command.full_name();
  if (!command.commands().empty()) return text + " COMMAND [OPTIONS] ...";
  std::string positional, needed;
  bool options = false;
  for (const auto& option : command.options()) {
    if (option->positional())
      positional += " " + positional_words(*option);
    else if (option->required)
      needed += fmt::format(" {} {}", option->names[0], option->value_name);
    else
      options = true;
  }
  return text + positional + needed + (options ? " [OPTIONS]" : "");
}

std::vector<std::string> examples_of(const CommandLine& command) {
  const std::string& footer = command.footer();
  const std::size_t at = footer.find(kExamplesHeading);
  std::vector<std::string> examples;
  if (at == std::string::npos) return examples;
  for (const std::string& line : parts_between(footer.substr(at + kExamplesHeading.size()), '\n')) {
    if (!line.starts_with("  ")) break;
    examples.push_back(line.substr(2));
  }
  return examples;
}

std::string remarks_of(const CommandLine& command) {
  const std::string& footer = command.footer();
  const std::size_t at = footer.find(kExamplesHeading);
  if (at == std::string::npos) return footer;
  std::size_t after = at + kExamplesHeading.size();
  while (after < footer.size() && footer.compare(after, 2, "  ") == 0)
    after = std::min(footer.find('\n', after), footer.size() - 1) + 1;
  std::string text = footer.substr(0, at) + footer.substr(after);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(std::min(text.find_first_not_of('\n'), text.size()));
}

std::vector<OptionGroup> option_groups_of(const CommandLine& command) {
  std::vector<OptionGroup> groups;
  for (const auto& option : command.options()) {
    const std::string heading = option->positional() ? "" : option->group;
    const bool first = heading.empty() || heading == "Options";  // positional arguments, then options without a heading
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.heading == heading; });
    if (group == groups.end()) {
      const bool after = heading == "Options" && !groups.empty() && groups[0].heading.empty();
      group = groups.insert(first ? groups.begin() + (after ? 1 : 0) : groups.end(), {heading, {}});
    }
    group->options.push_back(option.get());
  }
  const CommandLine& root = command.root();
  if (&root != &command && command.takes_common_options()) {
    OptionGroup common{"Options of every command", {}};
    for (const auto& option : root.options())
      if (option->name() != "--version") common.options.push_back(option.get());
    groups.push_back(common);
  }
  return groups;
}

namespace {

std::string lines_of_group(const OptionGroup& group, bool all = true) {
  std::string text;
  for (const OptionEntry* option : group.options) {
    if (option->advanced && !all) continue;
    if (text.empty()) text = group.heading.empty() ? "\n" : "\n" + group.heading + ":\n";
    text += entry_lines(option_words(*option),
                        option->what + (option->required && !option->positional() ? " (required)" : ""));
  }
  return text;
}

/// A heading as a word of the command line.
std::string word_of_heading(const std::string& heading) {
  std::string word;
  for (const char c : heading) word += c == ' ' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return word;
}

/// Names of the advanced options, which the short help omits.
std::string names_in(const OptionGroup& group) {
  std::string names;
  for (const OptionEntry* option : group.options)
    if (option->advanced) names += (names.empty() ? "" : " ") + option->name();
  return names;
}

/// "sansmesh help volume probe".
std::string help_line(const CommandLine& command) {
  return command.root().name() + " help" + (command.parent() ? " " + command.path() : "");
}

}  // namespace

std::string help_on_group(const CommandLine& command, const std::string& word) {
  for (const OptionGroup& group : option_groups_of(command))
    if (!group.heading.empty() && word_of_heading(group.heading) == word) return lines_of_group(group).substr(1);
  return "";
}

std::string help_on_views(const CommandLine& tool) {
  for (const auto& command : tool.commands())
    if (std::string text = help_on_group(*command, word_of_heading(kViewGroup)); !text.empty())
      return "Options of every command that draws pictures.\n\n" + text;
  return "";
}

std::string help_text(const CommandLine& command, bool all) {
  std::string text = command.what() + "\n\nUsage: " + usage_of(command) + "\n";
  if (!command.commands().empty()) {
    text += "\nCommands:\n";
    for (const auto& further : command.commands()) text += entry_lines(further->name(), further->what());
  }
  std::string named;
  for (const OptionGroup& group : option_groups_of(command)) {
    text += lines_of_group(group, all);
    if (all) continue;
    if (group.heading == kViewGroup)
      named += entry_lines(word_of_heading(group.heading),
                           "Size and view of pictures: " + command.root().name() + " help view");
    else if (const std::string names = names_in(group); !names.empty())
      named += entry_lines(word_of_heading(group.heading), names);
  }
  if (!named.empty())
    text += fmt::format("\nMore options: {} --help-all, or {} and one of these words:\n{}", command.full_name(),
                        help_line(command), named);
  if (!command.footer().empty())
    text += "\n" + command.footer().substr(command.footer().find_first_not_of('\n')) + "\n";
  return text;
}

std::string short_help(const CommandLine& command) {
  std::string text = command.what() + "\n\nUsage: " + usage_of(command) + "\n\n";
  for (const auto& further : command.commands()) text += entry_lines(further->name(), further->what());
  for (const auto& option : command.options())
    if (option->positional() || option->required) text += entry_lines(option_words(*option), option->what);
  const std::vector<std::string> examples = examples_of(command);
  if (!examples.empty()) text += "\nFor example:\n";
  for (std::size_t i = 0; i < std::min<std::size_t>(3, examples.size()); ++i) text += "  " + examples[i] + "\n";
  return text + "\nMore: " + help_line(command) + "\n";
}

}  // namespace sansmesh::cli
