// Table of commands and options, the source of parsing (parse_line.h), help (help_text.h), shell completion
// (completion.h) and the manual page (manual_page.h).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cli/line/option_entry.h"
#include "cli/report/report_json.h"

namespace sansmesh::cli {

/// Fluent interface that sets the properties of an option.
class Option {
 public:
  explicit Option(OptionEntry& entry) : entry_(&entry) {}

  /// Placeholder of the value in help: FILE, LENGTH.
  Option type_name(const std::string& name) const;
  /// Heading in the help.
  Option group(const std::string& name) const;
  Option required() const;
  Option one_of(const std::vector<std::string>& words) const;
  /// Range of numbers, ends included.
  Option within(double least, double most) const;
  /// Number of comma-separated numbers in one word.
  Option numbers(int count) const;
  /// Value if the option is given without one. The next word is its value only if it is a number, one of the allowed
  /// words, or one of `next_words`; other values need the form --flag=value.
  Option without_value(const std::string& value, const std::vector<std::string>& next_words = {}) const;
  /// May be repeated, each time with one value (or one list of numbers).
  Option repeated() const;
  /// Former name: accepted with a warning.
  Option former_name(const std::string& name) const;
  /// The value is an input file with one of these endings ({".ply", ".obj"}); any if empty.
  Option reads(const std::vector<std::string>& endings = {}) const;
  /// The value is an output file.
  Option writes(const std::vector<std::string>& endings = {}) const;

 private:
  Option names_file(OptionEntry::File file, const std::vector<std::string>& endings) const;

  OptionEntry* entry_;
};

/// A command with its options, or the whole tool with its commands. Global options are accepted anywhere.
class CommandLine {
 public:
  CommandLine(const std::string& what, const std::string& name);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// `names`: "-o,--output", or a name without dashes for a positional argument. T is a number, a text, a vector of
  /// these, or an optional one. The variable must live until the command has run.
  template <class T>
  Option add_option(const std::string& names, T& variable, const std::string& what);
  /// `use` is called with the value after parsing; it may throw ValueError.
  Option add_option_function(const std::string& names, std::function<void(const std::string&)> use,
                             const std::string& what);
  Option add_flag(const std::string& names, bool& variable, const std::string& what);
  Option add_flag_callback(const std::string& names, std::function<void()> use, const std::string& what);
  /// Text below the options in the help. Lines after "Examples:" are example commands.
  void footer(const std::string& text);

  /// Reports that --json may print for the command.
  void announce(const std::vector<AnnouncedReport>& reports) {
    announced_.insert(announced_.end(), reports.begin(), reports.end());
  }
  const std::vector<AnnouncedReport>& announced() const { return announced_; }

  /// For other kinds of options (schema_options.h).
  OptionEntry& add_entry(const std::string& names, OptionEntry::Kind kind, const std::string& what);

  /// Adds a subcommand; it lives as long as this.
  CommandLine& add_subcommand(const std::string& name, const std::string& what);
  /// Former name of the command: accepted with a warning.
  void former_name(const std::string& name) { old_name_ = name; }
  const std::string& old_name() const { return old_name_; }
  /// True if the user typed the former name.
  bool called_by_old_name = false;

  /// Direct subcommand with this current or former name; null if there is none.
  CommandLine* subcommand(const std::string& word) const;
  /// The global options do not apply to this command.
  void without_common_options() { common_ = false; }

  /// True if the command or the whole tool has that option.
  bool has(const std::string& flag) const { return find(flag) != nullptr; }
  /// Option by its flag; null if there is none.
  OptionEntry* find(const std::string& flag) const;

  const std::string& name() const { return name_; }
  /// "sansmesh volume probe".
  std::string full_name() const;
  /// "volume probe"; empty for the whole tool.
  std::string path() const;
  const std::string& what() const { return what_; }
  const std::string& footer() const { return footer_; }
  const CommandLine* parent() const { return parent_; }
  const CommandLine& root() const;
  CommandLine& root();
  bool takes_common_options() const { return common_; }
  const std::vector<std::unique_ptr<OptionEntry>>& options() const { return options_; }
  /// Direct subcommands.
  const std::vector<std::unique_ptr<CommandLine>>& commands() const { return commands_; }
  std::vector<std::string> command_names() const;
  /// This and all subcommands at any depth, each after its parent.
  std::vector<const CommandLine*> with_subcommands() const;

 private:
  std::string name_, what_, footer_, old_name_;
  CommandLine* parent_ = nullptr;
  bool common_ = true;
  std::vector<AnnouncedReport> announced_;
  std::vector<std::unique_ptr<OptionEntry>> options_;
  std::vector<std::unique_ptr<CommandLine>> commands_;
};

}  // namespace sansmesh::cli
