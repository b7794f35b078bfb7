#include "cli/line/schema_options.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "cli/line/command_line.h"
#include "cli/line/flags.h"
#include "cli/line/option_values.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/core/similar_words.h"
#include "sansmesh/error.h"

namespace sansmesh::cli {
namespace {

using Kind = OptionEntry::Kind;

/// Placeholder of the value in help: LENGTH for the unit "length".
std::string value_name_of(const OptionRow& row) {
  if (row.kind == OptionKind::numbers) return row.count == 3 ? "X,Y,Z" : row.count == 6 ? "BOX" : "NUMBERS";
  if (!row.unit.empty()) return upper_case(row.unit);
  switch (row.kind) {
    case OptionKind::whole:
      return "COUNT";
    case OptionKind::choice:
      return "NAME";
    case OptionKind::text:
    case OptionKind::texts:
      return row.suggestions.empty() ? "TEXT" : "CHOICE";
    default:
      return "NUMBER";
  }
}

Kind kind_of(OptionKind kind) {
  switch (kind) {
    case OptionKind::flag:
      return Kind::flag;
    case OptionKind::whole:
      return Kind::whole;
    case OptionKind::real:
    case OptionKind::numbers:
      return Kind::real;
    default:
      return Kind::text;
  }
}

/// Converts words of the command line to an option value.
OptionValue value_of_words(const OptionRow& row, const std::vector<std::string>& words) {
  switch (row.kind) {
    case OptionKind::whole:
      return static_cast<std::int64_t>(
          parse_whole(words.back(), std::numeric_limits<long long>::min(), std::numeric_limits<long long>::max()));
    case OptionKind::real:
      return parse_real(words.back());
    case OptionKind::numbers: {
      std::vector<double> numbers(words.size());
      std::transform(words.begin(), words.end(), numbers.begin(), parse_real);
      return numbers;
    }
    case OptionKind::texts:
      return words;
    default:
      return words.back();
  }
}

/// Default value as text; empty for the enumerator "none".
std::string usual_words_of(const OptionRow& row, const OptionValue& now) {
  const std::string usual = sansmesh::option_words(now);
  return row.kind == OptionKind::choice && usual == "none" ? "" : usual;
}

/// Description of the row, preceded by the methods that use it.
std::string sentence_of(const OptionRow& row, std::string_view text, const SchemaOptions& how) {
  std::string before = how.before ? how.before(row.name) : "", sentence(text);
  // Keeps the case of an initial abbreviation.
  if (!before.empty() && sentence.size() > 1 && !std::isupper(static_cast<unsigned char>(sentence[1])))
    sentence[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(sentence[0])));
  return before + sentence;
}

/// Description, range and default value: "Rounds, 1..10000 [10]".
std::string what_of(const OptionRow& row, const std::string& usual, const SchemaOptions& how) {
  std::string what = sentence_of(row, row.text, how);
  std::vector<std::string> words(row.choices.begin(), row.choices.end());
  const auto named = [&](const std::string& word) { return word == usual || what.find(word) != std::string::npos; };
  if (!std::all_of(words.begin(), words.end(), named)) what += ": " + joined_by_or(words);
  const bool number = row.kind == OptionKind::whole || row.kind == OptionKind::real;
  // Positive ranges of lengths are not shown.
  if (const std::string range = row.range.words(); number && std::isfinite(row.range.most) && !range.empty())
    what += ", " + range;
  const std::string otherwise = usual.empty() ? std::string(row.from_data) : usual;
  if (!otherwise.empty()) what += " [" + otherwise + "]";
  if (!row.implied.empty()) what += " [no value: " + std::string(row.implied) + "]";
  return what;
}

void add_flag_of_row(CommandLine& c, const OptionRow& row, void* owner, bool value, bool usual,
                     const SchemaOptions& how) {
  const std::string negative = row.negative.empty() ? "no_" + std::string(row.name) : std::string(row.negative);
  std::string what = sentence_of(row, value || row.negative_text.empty() ? row.text : row.negative_text, how);
  if (value && !row.from_data.empty()) what += " [" + std::string(row.from_data) + "]";
  OptionEntry& entry = c.add_entry(flag_of_name(value ? row.name : std::string_view(negative)), Kind::flag, what);
  entry.group = how.group;
  entry.row = &row;
  entry.in_order = row.step;
  // The two flags of a pair exclude each other.
  if (value && row.optional && !row.step) entry.excludes = flag_of_name(negative);
  // A flag that is on by default only has its negation, which also keeps the old name.
  if (value != usual && !row.old_name.empty()) entry.old_names.push_back(flag_of_name(row.old_name));
  entry.field = value ? std::string(row.name) : std::string(row.name) + " = false";
  entry.use = [&row, owner, value](const std::vector<std::string>&) { set_option(row, owner, value); };
}

void add_row(CommandLine& c, const OptionRow& row, void* owner, const SchemaOptions& how) {
  const OptionValue now = option_value(row, owner);
  if (row.step && row.kind == OptionKind::flag) return add_flag_of_row(c, row, owner, true, false, how);
  if (row.kind == OptionKind::flag) {
    const bool* const value = std::get_if<bool>(&now);
    const bool usual = value && *value;
    if (!usual) add_flag_of_row(c, row, owner, true, usual, how);
    if (!value || usual) add_flag_of_row(c, row, owner, false, usual, how);
    return;
  }
  const std::string usual = usual_words_of(row, now);
  OptionEntry& entry = c.add_entry(flag_of_name(row.name), kind_of(row.kind), what_of(row, usual, how));
  entry.group = how.group;
  entry.row = &row;
  entry.field = row.name;
  entry.usual = usual;
  entry.value_name = value_name_of(row);
  if (row.unit == "file") entry.file = OptionEntry::File::read;
  entry.endings.assign(row.endings.begin(), row.endings.end());
  if (!row.range.words().empty()) entry.range = row.range;
  entry.words.assign(row.choices.begin(), row.choices.end());
  if (row.kind == OptionKind::numbers) entry.numbers = row.count, entry.several = row.count == 0;
  // A list may be given in several parts.
  entry.repeated = row.kind == OptionKind::texts || entry.several || row.step;
  entry.in_order = row.step;
  if (row.has_implied_value()) entry.implied = std::string(row.implied);
  entry.next_words.assign(row.suggestions.begin(), row.suggestions.end());
  if (!row.old_name.empty()) entry.old_names.push_back(flag_of_name(row.old_name));
  if (!row.excludes.empty()) entry.excludes = flag_of_name(row.excludes);
  entry.use = [&row, owner](const std::vector<std::string>& words) {
    with_flags_in_errors([&] { set_option(row, owner, value_of_words(row, words)); });
  };
}

/// Calls `use` for every row except those of all pictures, which add_picture_options() adds.
void for_each_own_option(std::span<const OptionRow> rows, void* options,
                         const std::function<void(const OptionRow& row, void* owner)>& use) {
  for (const OptionRow& row : rows)
    if (row.kind != OptionKind::group && row.kind != OptionKind::steps)
      use(row, options);
    else if (row.name != "picture")
      for_each_own_option(row.rows, row.part(options), use);
}

}  // namespace

void add_schema(CommandLine& c, const OptionSchema& schema, void* options, const SchemaOptions& how) {
  const auto among = [](const std::vector<std::string_view>& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  std::vector<std::string_view> names;
  for_each_own_option(schema.rows, options, [&](const OptionRow& row, void*) { names.push_back(row.name); });
  for (const auto* const list : {&how.only, &how.without})
    for (const std::string_view name : *list)
      if (!among(names, name)) throw std::logic_error("no option is called " + std::string(name));
  for_each_own_option(schema.rows, options, [&](const OptionRow& row, void* owner) {
    if ((how.only.empty() || among(how.only, row.name)) && !among(how.without, row.name)) add_row(c, row, owner, how);
  });
}

void with_flags_in_errors(const std::function<void()>& call) {
  try {
    call();
  } catch (const ArgumentError& error) {
    const ArgumentFault& fault = error.fault();
    if (fault.allowed.empty()) throw ValueError(error.what());
    throw ValueError("must be " + fault.allowed + (fault.value.empty() ? "" : ", not " + fault.value));
  }
}

void name_flags(CommandLine& command) {
  for (const auto& option : command.options()) {
    if (option->row) option->what = in_flags(option->what, command);
    // Old names that are names of other options are dropped.
    std::erase_if(option->old_names, [&](const std::string& old) { return command.find(old) != option.get(); });
  }
}

}  // namespace sansmesh::cli
