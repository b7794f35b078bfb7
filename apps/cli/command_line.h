// How commands declare their options. CLI11, which carries this out, takes seconds to compile: only command_line.cpp
// includes it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace sansmesh::cli {

/// What can be said of an option besides its names. Returns itself, so that all is said in a row.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}

  /// What help calls its value: FILE.
  Option type_name(const std::string& name) const;
  /// Heading in the help.
  Option group(const std::string& name) const;
  Option required() const;
  Option one_of(const std::vector<std::string>& words) const;
  /// Whole numbers of a range, ends included.
  Option within(int least, int most) const;
  Option positive() const;
  /// So many numbers in one word, with commas between them.
  Option numbers(int count) const;
  /// Stands for this value where it is given without one.
  Option without_value(const std::string& value) const;
  /// May be repeated, with one value each time.
  Option repeated() const;

 private:
  CLI::Option* option_;
};

/// What is wrong with the value of an option.
struct ValueError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A command with its options, or the whole tool with its commands.
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
  Option add_option_function(const std::string& names, std::function<void(const std::vector<double>&)> use,
                             const std::string& what);
  Option add_flag(const std::string& names, bool& variable, const std::string& what);
  Option add_flag_callback(const std::string& names, std::function<void()> use, const std::string& what);
  /// One of a few words that stand for values of `variable`, an enumeration or an optional one.
  template <class Value, class Variable>
  Option add_choice(const std::string& names, Variable& variable,
                    const std::vector<std::pair<std::string, Value>>& choices, const std::string& what) {
    std::vector<std::string> words;
    std::vector<Value> values;
    for (const auto& [word, value] : choices) {
      words.push_back(word);
      values.push_back(value);
    }
    return add_words(
        names, std::move(words), [values, &variable](std::size_t chosen) { variable = values[chosen]; }, what);
  }
  void footer(const std::string& text);

  /// A command of this tool; lives as long as this.
  CommandLine& add_subcommand(const std::string& name, const std::string& what);
  /// Of this and no other level.
  const CommandLine& subcommand(const std::string& name) const;
  /// One of the commands of this must be given.
  void require_subcommand();
  /// Whether the words of the command line chose this command.
  bool chosen() const;
  bool has(const std::string& flag) const;
  /// What reads the words of the command line and prints the help.
  CLI::App& app() const { return *app_; }

 private:
  explicit CommandLine(CLI::App& app);
  Option add_words(const std::string& names, std::vector<std::string> words,
                   const std::function<void(std::size_t)>& use, const std::string& what);

  std::unique_ptr<CLI::App> own_;  // of the whole tool
  CLI::App* app_;
  std::vector<std::unique_ptr<CommandLine>> commands_;
};

}  // namespace sansmesh::cli
