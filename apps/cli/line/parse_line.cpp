#include "cli/line/parse_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include "cli/input/standard_streams.h"
#include "cli/line/help_levels.h"
#include "cli/line/option_values.h"
#include "cli/line/suggestions.h"
#include "sansmesh/error.h"

namespace sansmesh::cli {
namespace {

bool looks_like_an_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && !are_numbers(word) && word.find_first_of(" <>=.") != 1;
}

/// A word that starts like a number is a mistyped one, unless it is a file.
bool begins_like_a_number(const std::string& word) {
  std::error_code ignored;
  return !word.empty() && (std::isdigit(static_cast<unsigned char>(word[0])) || word[0] == '.') && word.size() > 1 &&
         std::isalnum(static_cast<unsigned char>(word[1])) && word.find('.', 1) == std::string::npos &&
         !std::filesystem::exists(word, ignored);
}

std::string joined_by_commas(const std::vector<std::string>& parts) { return fmt::format("{}", fmt::join(parts, ",")); }

/// "unknown command 'prob' of volume (did you mean probe?)".
UsageError unknown_command(const CommandLine& at, const std::string& word) {
  std::string hint = did_you_mean(word, at.command_names());
  if (!at.parent()) {
    for (const auto& option : at.options())  // version
      if (option->name() == "--" + word) hint = " (did you mean " + option->name() + "?)";
    // Commands of groups, by their full names.
    for (const auto& group : at.commands())
      for (const auto& command : group->commands())
        if (hint.empty() && command->name() == word)
          hint = " (did you mean " + group->name() + " " + command->name() + "?)";
    std::error_code ignored;
    if (hint.empty() && std::filesystem::exists(word, ignored))
      hint = ": a command comes first, as in sansmesh info " + word;
    return UsageError(at, "unknown command " + in_quotes(word) + hint);
  }
  return UsageError(at, fmt::format("unknown command {} of {}{}", in_quotes(word), at.name(), hint));
}

void add_names_of_options(const CommandLine& line, std::vector<std::string>& names) {
  for (const auto& option : line.options())
    if (!option->positional()) names.insert(names.end(), option->names.begin(), option->names.end());
}

UsageError unknown_option(const CommandLine& at, const std::string& flag) {
  if (at.root().has(flag)) return UsageError(at, fmt::format("{} means nothing to {}", flag, at.name()));
  std::vector<std::string> known;
  add_names_of_options(at, known);
  if (at.parent() && at.takes_common_options()) add_names_of_options(at.root(), known);
  std::string hint;
  std::size_t bare = 0;  // dashes of any kind: -output, —depth
  for (const std::string dash : {"-", "–", "—"})
    while (flag.compare(bare, dash.size(), dash) == 0) bare += dash.size();
  if (at.has("--" + flag.substr(bare))) hint = fmt::format(" (did you mean --{}?)", flag.substr(bare));
  if (hint.empty()) hint = did_you_mean(flag, known);
  std::vector<std::string> others;
  if (hint.empty() || !at.commands().empty())
    for (const CommandLine* const command : at.root().with_subcommands())
      if (command->commands().empty() && command->has(flag)) others.push_back(command->path());
  if (!others.empty()) {
    if (others.size() > 4) others.resize(4), others.back() = "others";
    std::string list;
    for (std::size_t i = 0; i < others.size(); ++i)
      list += (i == 0 ? "" : i + 1 == others.size() ? " and " : ", ") + others[i];
    hint = at.commands().empty()
               ? fmt::format(" (it is an option of {})", list)
               : fmt::format(" here: options of a command come after it (it is an option of {})", list);
  }
  return UsageError(at, "unknown option " + printable(flag, 60) + hint);
}

/// One occurrence of an option whose order counts, with its range of values.
struct Given {
  OptionEntry* option;
  std::size_t first, count;
};

/// Reads the words in one pass.
class LineReader {
 public:
  LineReader(CommandLine& root, const std::vector<std::string>& words) : at_(&root), words_(words) {}

  ParsedLine read() {
    if (CommandLine* const asked = help_requested({"--help", "-h"})) return {ParsedLine::Action::help, asked};
    if (CommandLine* const asked = help_requested({"--help-all"})) return {ParsedLine::Action::help_all, asked};
    bool only_words = false;
    for (; next_ < words_.size(); ++next_) {
      const std::string& word = words_[next_];
      if (!only_words && (word.starts_with("–") || word.starts_with("—")))  // typographic dashes, as in printed text
        throw unknown_option(*at_, word.substr(0, word.find('=')));
      if (!only_words && word == "--")
        only_words = true;
      else if (!only_words && looks_like_an_option(word))
        read_option(word);
      else if (!at_->commands().empty())
        enter(word);
      else
        positional_.push_back(word), ++typed_;
    }
    if (const OptionEntry* version = at_->root().find("--version"); version && !version->typed.empty())
      return {ParsedLine::Action::version, at_};
    if (!at_->commands().empty())
      throw UsageError(*at_, at_->parent() ? at_->name() + " needs one of its commands" : "which command?",
                       typed_ == 0);
    if (typed_ == 0) require();
    assign_positional();
    return {ParsedLine::Action::run, at_};
  }

  const std::vector<Given>& given_in_order() const { return given_; }

  /// Checks that nothing is missing. Wrong values are reported earlier.
  void require() const {
    std::string missing;
    for (const auto& option : at_->options())
      if (option->required && option->values.empty())
        missing += (missing.empty() ? "" : " and ") + option->name() + " " + option->value_name;
    if (!missing.empty())
      throw UsageError(*at_, fmt::format("{} needs {}{}", at_->name(), missing, suggested_output()), typed_ == 0);
    for (const auto& option : at_->options())
      if (const OptionEntry* other = at_->find(option->excludes);
          other && !option->typed.empty() && !other->typed.empty())
        throw UsageError(*at_, fmt::format("{} and {} exclude each other", option->typed, other->typed));
    // Checked here, since the library cannot distinguish a given default value from a missing one.
    for (const auto& option : at_->options())
      if (const OptionEntry* other = needed_by(*option);
          other && !option->typed.empty() && other->typed.empty() && other->values.empty())
        throw UsageError(*at_, fmt::format("{} needs {}", option->typed, other->name()));
  }

 private:
  /// The option that this one requires; null if there is none.
  const OptionEntry* needed_by(const OptionEntry& option) const {
    if (!option.row || option.row->needs.empty()) return nullptr;
    for (const auto& other : at_->options())
      if (other->field == option.row->needs) return other.get();
    return nullptr;
  }

  /// The command whose help is requested by one of these options, at any position.
  CommandLine* help_requested(const std::vector<std::string>& options) const {
    const auto end = std::find(words_.begin(), words_.end(), "--");
    if (std::find_first_of(words_.begin(), end, options.begin(), options.end()) == end) return nullptr;
    CommandLine* command = at_;
    for (auto word = words_.begin(); word != end; ++word)
      if (CommandLine* const further = command->subcommand(*word)) command = further;
    return command;
  }

  void enter(const std::string& word) {
    CommandLine* const command = at_->subcommand(word);
    if (!command) throw unknown_command(*at_, word);
    at_ = command;
    at_->called_by_old_name = at_->name() != word;
  }

  void read_option(const std::string& word) {
    ++typed_;
    std::string flag = word, value;
    bool attached = false;
    if (word[1] == '-') {  // --flag=value
      if (const std::size_t is = word.find('='); is != std::string::npos)
        flag = word.substr(0, is), value = word.substr(is + 1), attached = true;
    } else if (word.size() > 2 && at_->has(word.substr(0, 2)) && !at_->has("-" + word)) {  // -ovalue
      flag = word.substr(0, 2), value = word.substr(word[2] == '=' ? 3 : 2), attached = true;
    }
    OptionEntry* const option = at_->find(flag);
    if (!option) throw unknown_option(*at_, flag);
    if (!option->typed.empty() && !option->repeated && option->kind != OptionEntry::Kind::flag)
      throw UsageError(*at_, flag + " is given twice");
    option->typed = flag;
    const std::size_t before = option->values.size();
    if (option->kind == OptionEntry::Kind::flag) {
      if (attached) throw UsageError(*at_, fmt::format("{} takes no value, not {}", flag, in_quotes(value)));
    } else {
      take_values(*option, attached ? &value : nullptr);
    }
    if (option->in_order) given_.push_back({option, before, option->values.size() - before});
  }

  /// True if the next word may be a value, judged by the command line alone.
  bool value_follows() const {
    if (next_ + 1 >= words_.size()) return false;
    const std::string& word = words_[next_ + 1];
    if (word.size() < 2 || word[0] != '-' || are_numbers(word)) return true;
    return word.substr(0, 2) != "--" && !at_->has(word);
  }

  void take_values(OptionEntry& o, const std::string* attached) {
    const bool numbers = o.kind == OptionEntry::Kind::whole || o.kind == OptionEntry::Kind::real;
    if (o.implied && !attached) {
      const auto fits = [&](const std::string& word) {
        if (!word.empty() && word == *o.implied) return true;
        if (std::find(o.next_words.begin(), o.next_words.end(), word) != o.next_words.end()) return true;
        return o.words.empty() ? are_numbers(word) || begins_like_a_number(word)
                               : std::find(o.words.begin(), o.words.end(), word) != o.words.end();
      };
      const bool given = value_follows() && fits(words_[next_ + 1]);
      o.values.push_back(given ? words_[++next_] : *o.implied);
      return;
    }
    if (!attached && !value_follows())
      throw UsageError(*at_, next_ + 1 < words_.size() ? fmt::format("{} needs a value ({}) before {}", o.typed,
                                                                     o.value_name, printable(words_[next_ + 1], 60))
                                                       : fmt::format("{} needs a value ({})", o.typed, o.value_name));
    const std::string first = attached ? *attached : words_[++next_];
    if (numbers && !are_numbers(first)) {  // reported here, before the next word is misinterpreted
      try {
        parse_real(first);
      } catch (const ValueError& error) {
        throw UsageError(*at_, o.typed + (error.what()[0] == 'm' ? " " : ": ") + error.what() + number_hint(o, first));
      }
    }
    if (o.numbers == 0 && !o.several) return o.values.push_back(first);
    std::vector<std::string> taken = numbers ? between_commas(first) : std::vector{first};
    const std::size_t most = o.numbers > 0 ? static_cast<std::size_t>(o.numbers) : words_.size();
    while (!attached && numbers && taken.size() < most && next_ + 1 < words_.size() && are_numbers(words_[next_ + 1]))
      for (std::string& part : between_commas(words_[++next_])) taken.push_back(std::move(part));
    if (o.numbers > 0 && taken.size() != most)
      throw UsageError(*at_, fmt::format("{} needs {} comma-separated numbers, not {}", o.typed, most,
                                         in_quotes(joined_by_commas(taken))));
    o.values.insert(o.values.end(), taken.begin(), taken.end());
  }

  /// Assigns the positional words.
  void assign_positional() {
    std::size_t next = 0;
    OptionEntry* last = nullptr;
    for (const auto& option : at_->options()) {
      if (!option->positional()) continue;
      last = option.get();
      const std::size_t end = option->several ? positional_.size() : std::min(next + 1, positional_.size());
      for (; next < end; ++next) last->values.push_back(positional_[next]), last->typed = last->name();
    }
    if (next == positional_.size()) return;
    const std::string what = last ? "one " + last->name() : "options only";
    throw UsageError(*at_, fmt::format("{} is left over: {} takes {}{}", in_quotes(positional_[next]), at_->name(),
                                       what, suggested_option(positional_[next])));
  }

  /// " (did you mean --at 1,2,3?)" if one option of the command takes that many numbers, except options of views.
  std::string suggested_option(const std::string& word) const {
    if (!are_numbers(word)) return "";
    const auto count = 1 + std::count(word.begin(), word.end(), ',');
    std::string hint;
    for (const auto& option : at_->options()) {
      if (option->positional() || option->numbers != count || option->group == kViewGroup) continue;
      if (!hint.empty()) return "";
      hint = fmt::format(" (did you mean {} {}?)", option->name(), printable(word, 60));
    }
    return hint;
  }

  /// " (did you mean -o x.ply?)" if the last word could be an output file and does not exist.
  std::string suggested_output() const {
    std::error_code ignored;
    if (positional_.size() < 2 || std::filesystem::exists(positional_.back(), ignored)) return "";
    for (const auto& option : at_->options())
      if (option->required && option->values.empty() && !option->positional())
        for (const std::string& ending : option->endings)
          if (positional_.back().ends_with(ending))
            return fmt::format(" (did you mean {} {}?)", option->names[0], printable(positional_.back(), 60));
    return "";
  }

  CommandLine* at_;
  const std::vector<std::string>& words_;
  std::size_t next_ = 0;
  std::size_t typed_ = 0;  // words beside those of the command
  std::vector<std::string> positional_;
  std::vector<Given> given_;
};

void use_option(CommandLine& command, const OptionEntry& option, const std::vector<std::string>& values) {
  try {
    for (const std::string& value : values) check_value(option, value);
    if (option.use) option.use(values);
  } catch (const ValueError& error) {
    std::string cause = error.what();
    if (cause.ends_with(" is not a number")) cause += number_hint(option, values.back());
    throw UsageError(command,
                     option.typed + (cause.starts_with("must ") ? " " : ": ") + cause +
                         (option.kind == OptionEntry::Kind::text ? did_you_mean_listed(cause, values.back()) : ""));
  }
}

void use_options(CommandLine& command, const CommandLine& of) {
  for (const auto& option : of.options())
    if (!option->typed.empty() && !option->in_order) use_option(command, *option, option->values);
}

void use_in_order(CommandLine& command, const std::vector<Given>& given) {
  for (const Given& g : given) {
    const auto first = g.option->values.begin() + static_cast<std::ptrdiff_t>(g.first);
    use_option(command, *g.option, {first, first + static_cast<std::ptrdiff_t>(g.count)});
  }
}

/// "--depth must lie in 2..14", with the given value.
std::string with_value(std::string text, const OptionEntry& option) {
  if (option.kind == OptionEntry::Kind::flag || option.values.empty()) return text;
  const std::string value = joined_by_commas(option.repeated ? std::vector{option.values.back()} : option.values);
  const std::string rest = text.substr(option.typed.size());
  if (!rest.starts_with(" must ") || rest.find(", not ") != std::string::npos || rest.find(value) != std::string::npos)
    return text;
  // Inserted before a remark in brackets or after a colon.
  const std::size_t end = std::min({rest.find(" ("), rest.find(": "), rest.find("; "), rest.size()});
  return text.insert(option.typed.size() + end, ", not " + printable(value, 60));
}

/// Adds the option to a message such as "unknown view 'tpo': front, top or iso".
std::string of_option(const std::string& message, const OptionEntry& option) {
  const std::string bare = option.name().substr(2) + " '";
  const bool named = message.starts_with(bare);  // plane 'w': must be like …
  return option.typed + (named ? message.substr(bare.size() - 2) : ": " + message);
}

}  // namespace

ParsedLine parse_line(CommandLine& root, const std::vector<std::string>& words) {
  LineReader reader(root, words);
  const ParsedLine parsed = reader.read();
  if (parsed.action != ParsedLine::Action::run) return parsed;
  CommandLine& command = *parsed.command;
  name_standard_streams(command);
  use_options(command, command);
  use_in_order(command, reader.given_in_order());
  if (command.parent()) {
    for (const auto& option : command.root().options())
      if (!option->typed.empty() && !command.takes_common_options())
        throw UsageError(command, fmt::format("{} means nothing to {}", option->typed, command.name()));
    use_options(command, command.root());
  }
  reader.require();
  return parsed;
}

const CommandLine& command_of(const CommandLine& root, const std::vector<std::string>& words) {
  const CommandLine* at = &root;
  for (const std::string& word : words) {
    if (at->commands().empty())
      throw UsageError(*at, fmt::format("{} has no commands, so {} is unknown", at->name(), in_quotes(word)));
    const CommandLine* const command = at->subcommand(word);
    if (!command) throw unknown_command(*at, word);
    at = command;
  }
  return *at;
}

std::string with_typed_values(const std::string& message, const CommandLine& command) {
  const std::string flag = message.substr(0, message.find_first_of(" :=,"));
  if (const OptionEntry* option = flag.starts_with("-") ? command.find(flag) : nullptr)
    return option->typed.empty() ? message : with_value(option->typed + message.substr(flag.size()), *option);
  for (const CommandLine* line : {&command, &command.root()})
    for (const auto& option : line->options())
      if (!option->positional() && !option->typed.empty())
        for (const std::string& value : option->values)
          if (message.find("'" + value + "'") != std::string::npos && message.find("--") == std::string::npos)
            return of_option(message, *option);
  return message;
}

}  // namespace sansmesh::cli
