#include "cli/line/command_line.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>

#include "cli/line/option_values.h"

namespace sansmesh::cli {
namespace {

// Kind of an option's variable, and conversion of words to its value.
template <class T>
struct Variable;

template <>
struct Variable<std::string> {
  static constexpr auto kind = OptionEntry::Kind::text;
  static void read(std::string& v, const std::string& word) { v = word; }
};
template <>
struct Variable<double> {
  static constexpr auto kind = OptionEntry::Kind::real;
  static void read(double& v, const std::string& word) { v = parse_real(word); }
};
template <>
struct Variable<int> {
  static constexpr auto kind = OptionEntry::Kind::whole;
  static void read(int& v, const std::string& word) {
    v = static_cast<int>(parse_whole(word, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()));
  }
};

template <class T>
struct Read : Variable<T> {
  static constexpr bool several = false;
  static void from(T& v, const std::vector<std::string>& words) { Variable<T>::read(v, words.back()); }
};
template <class T>
struct Read<std::optional<T>> : Variable<T> {
  static constexpr bool several = false;
  static void from(std::optional<T>& v, const std::vector<std::string>& words) {
    Variable<T>::read(v.emplace(), words.back());
  }
};
template <class T>
struct Read<std::vector<T>> : Variable<T> {
  static constexpr bool several = true;
  static void from(std::vector<T>& v, const std::vector<std::string>& words) {
    v.resize(words.size());
    for (std::size_t i = 0; i < words.size(); ++i) Variable<T>::read(v[i], words[i]);
  }
};

}  // namespace

Option Option::type_name(const std::string& name) const {
  entry_->value_name = name;
  return *this;
}
Option Option::group(const std::string& name) const {
  entry_->group = name;
  return *this;
}
Option Option::required() const {
  entry_->required = true;
  return *this;
}
Option Option::one_of(const std::vector<std::string>& words) const {
  entry_->words = words;
  return *this;
}
Option Option::within(double least, double most) const {
  entry_->range = OptionRange{least, most};
  return *this;
}
Option Option::numbers(int count) const {
  entry_->numbers = count;
  entry_->several = false;
  return *this;
}
Option Option::without_value(const std::string& value, const std::vector<std::string>& next_words) const {
  entry_->implied = value;
  entry_->next_words = next_words;
  return *this;
}
Option Option::repeated() const {
  entry_->repeated = true;
  entry_->several = false;
  return *this;
}
Option Option::former_name(const std::string& name) const {
  entry_->old_names.push_back(name);
  return *this;
}
Option Option::reads(const std::vector<std::string>& endings) const {
  return names_file(OptionEntry::File::read, endings);
}
Option Option::writes(const std::vector<std::string>& endings) const {
  return names_file(OptionEntry::File::written, endings);
}
Option Option::names_file(OptionEntry::File file, const std::vector<std::string>& endings) const {
  entry_->file = file, entry_->endings = endings;
  if (entry_->value_name == OptionEntry().value_name) entry_->value_name = "FILE";
  return *this;
}

CommandLine::CommandLine(const std::string& what, const std::string& name) : name_(name), what_(what) {}
CommandLine::~CommandLine() = default;

OptionEntry& CommandLine::add_entry(const std::string& names, OptionEntry::Kind kind, const std::string& what) {
  OptionEntry& entry = *options_.emplace_back(std::make_unique<OptionEntry>());
  entry.names = between_commas(names);
  entry.kind = kind;
  entry.what = what;
  return entry;
}

template <class T>
Option CommandLine::add_option(const std::string& names, T& variable, const std::string& what) {
  OptionEntry& entry = add_entry(names, Read<T>::kind, what);
  entry.several = Read<T>::several;
  entry.use = [&variable](const std::vector<std::string>& words) { Read<T>::from(variable, words); };
  return Option(entry);
}
template Option CommandLine::add_option(const std::string&, int&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::string&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option CommandLine::add_option(const std::string&, std::optional<std::string>&, const std::string&);

Option CommandLine::add_option_function(const std::string& names, std::function<void(const std::string&)> use,
                                        const std::string& what) {
  OptionEntry& entry = add_entry(names, OptionEntry::Kind::text, what);
  entry.use = [use = std::move(use)](const std::vector<std::string>& words) {
    for (const std::string& word : words) use(word);
  };
  return Option(entry);
}
Option CommandLine::add_flag(const std::string& names, bool& variable, const std::string& what) {
  return add_flag_callback(
      names, [&variable] { variable = true; }, what);
}
Option CommandLine::add_flag_callback(const std::string& names, std::function<void()> use, const std::string& what) {
  OptionEntry& entry = add_entry(names, OptionEntry::Kind::flag, what);
  entry.use = [use = std::move(use)](const std::vector<std::string>&) { use(); };
  return Option(entry);
}

void CommandLine::footer(const std::string& text) { footer_ = text; }

CommandLine& CommandLine::add_subcommand(const std::string& name, const std::string& what) {
  CommandLine& command = *commands_.emplace_back(std::make_unique<CommandLine>(what, name));
  command.parent_ = this;
  return command;
}

CommandLine* CommandLine::subcommand(const std::string& word) const {
  for (const auto& command : commands_)
    if (command->name_ == word || (!word.empty() && command->old_name_ == word)) return command.get();
  return nullptr;
}

std::vector<std::string> CommandLine::command_names() const {
  std::vector<std::string> names;
  names.reserve(commands_.size());
  for (const auto& command : commands_) names.push_back(command->name_);
  return names;
}

std::vector<const CommandLine*> CommandLine::with_subcommands() const {
  std::vector<const CommandLine*> all{this};
  for (const auto& command : commands_) {
    const std::vector<const CommandLine*> further = command->with_subcommands();
    all.insert(all.end(), further.begin(), further.end());
  }
  return all;
}

OptionEntry* CommandLine::find(const std::string& flag) const {
  if (flag.empty()) return nullptr;
  for (const auto names : {&OptionEntry::names, &OptionEntry::old_names})
    for (const auto& option : options_)
      if (const auto& all = (*option).*names;
          !option->positional() && std::find(all.begin(), all.end(), flag) != all.end())
        return option.get();
  return parent_ && common_ ? root().find(flag) : nullptr;
}

std::string CommandLine::full_name() const { return parent_ ? parent_->full_name() + " " + name_ : name_; }
std::string CommandLine::path() const { return parent_ ? full_name().substr(root().name_.size() + 1) : ""; }

const CommandLine& CommandLine::root() const { return parent_ ? parent_->root() : *this; }
CommandLine& CommandLine::root() { return parent_ ? parent_->root() : *this; }

}  // namespace sansmesh::cli
