// How commands declare their options: a table from which words are parsed (parse_line.h), help (help_text.h), shell
// completion (completion.h) and the manual page (manual_page.h) are made.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/line/option_entry.h"
#include "cli/report/report_json.h"

namespace sansmesh::cli {

/// What can be said of an option besides its names. Returns itself, so that all is said in a row.
class Option {
 public:
  explicit Option(OptionEntry& entry) : entry_(&entry) {}

  /// The name of its value in help: FILE, LENGTH.
  Option type_name(const std::string& name) const;
  /// Heading in the help.
  Option group(const std::string& name) const;
  Option required() const;
  Option one_of(const std::vector<std::string>& words) const;
  /// Numbers of a range, ends included.
  Option within(double least, double most) const;
  /// So many numbers in one word, with commas between them.
  Option numbers(int count) const;
  /// Stands for this value where it is given without one. The next word is its value only if it is a number, one of the
  /// words that it takes, or one of `next_words`; others can be given as --flag=value.
  Option without_value(const std::string& value, const std::vector<std::string>& next_words = {}) const;
  /// May be repeated, with one value (or so many numbers) each time.
  Option repeated() const;
  /// A name that it had: understood, and warned of.
  Option once_called(const std::string& name) const;
  /// It names a file that is read, with one of these endings ({".ply", ".obj"}), or any if there are none.
  Option reads(const std::vector<std::string>& endings = {}) const;
  /// The same of a file that is written.
  Option writes(const std::vector<std::string>& endings = {}) const;

 private:
  Option names_file(OptionEntry::File file, const std::vector<std::string>& endings) const;

  OptionEntry* entry_;
};

/// A command with its options, or the whole tool with its commands. The options of the whole tool can be given
/// anywhere.
class CommandLine {
 public:
  CommandLine(const std::string& what, const std::string& name);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// `names`: "-o,--output", or without dashes what is told from its place. T is a number, a text, a vector of them, or
  /// an optional one. The variable must live until the command has run.
  template <class T>
  Option add_option(const std::string& names, T& variable, const std::string& what);
  /// `use` is called with the value once all is read; it may throw ValueError.
  Option add_option_function(const std::string& names, std::function<void(const std::string&)> use,
                             const std::string& what);
  Option add_flag(const std::string& names, bool& variable, const std::string& what);
  Option add_flag_callback(const std::string& names, std::function<void()> use, const std::string& what);
  /// Text of the help below the options. Lines after one that is "Examples:" are commands to try.
  void footer(const std::string& text);

  /// Reports that the command may tell with --json.
  void tells(const std::vector<ToldReport>& reports) { told_.insert(told_.end(), reports.begin(), reports.end()); }
  const std::vector<ToldReport>& told() const { return told_; }

  /// For what makes options of its own kind (schema_options.h).
  OptionEntry& add_entry(const std::string& names, OptionEntry::Kind kind, const std::string& what) {
    return add(names, kind, what);
  }

  /// A command of this tool; lives as long as this.
  CommandLine& add_subcommand(const std::string& name, const std::string& what);
  /// A name that the command had: understood, and warned of.
  void once_called(const std::string& name) { old_name_ = name; }
  const std::string& old_name() const { return old_name_; }
  /// By its name, or its old one.
  bool is_called(const std::string& word) const { return name_ == word || (!word.empty() && old_name_ == word); }
  /// True if the user typed the old name.
  bool called_by_old_name = false;

  /// Of this and no other level.
  const CommandLine& subcommand(const std::string& name) const;
  /// The options of the whole tool mean nothing to this command.
  void without_common_options() { common_ = false; }

  /// Whether there is such an option, of the whole tool's too.
  bool has(const std::string& flag) const { return find(flag) != nullptr; }
  /// The option that is typed so; null if there is none.
  const OptionEntry* find(const std::string& flag) const;
  OptionEntry* find(const std::string& flag);

  const std::string& name() const { return name_; }
  /// "sansmesh volume probe".
  std::string full_name() const;
  const std::string& what() const { return what_; }
  const std::string& footer() const { return footer_; }
  const CommandLine* parent() const { return parent_; }
  const CommandLine& root() const;
  CommandLine& root();
  bool takes_common_options() const { return common_; }
  const std::vector<std::unique_ptr<OptionEntry>>& options() const { return options_; }
  const std::vector<std::unique_ptr<CommandLine>>& commands() const { return commands_; }

 private:
  OptionEntry& add(const std::string& names, OptionEntry::Kind kind, const std::string& what);

  std::string name_, what_, footer_, old_name_;
  CommandLine* parent_ = nullptr;
  bool common_ = true;
  std::vector<ToldReport> told_;
  std::vector<std::unique_ptr<OptionEntry>> options_;
  std::vector<std::unique_ptr<CommandLine>> commands_;
};

}  // namespace sansmesh::cli
