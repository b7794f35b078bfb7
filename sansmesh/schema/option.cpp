#include "sansmesh/option.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

std::string shown(double v) { return fmt::format("{:.12g}", v); }

std::string joined(std::span<const std::string_view> words) { return fmt::format("{}", fmt::join(words, ", ")); }

/// Range as the end of "must be …".
std::string allowed_words(const OptionRange& r) {
  if (std::isinf(r.most) && std::isinf(r.least)) return "finite";
  if (std::isinf(r.most)) return r.above ? "above " + shown(r.least) : "at least " + shown(r.least);
  if (std::isinf(r.least)) return r.below ? "below " + shown(r.most) : "at most " + shown(r.most);
  if (!r.above && !r.below) return fmt::format("from {} to {}", shown(r.least), shown(r.most));
  return fmt::format("{} {} and {} {}", r.above ? "above" : "at least", shown(r.least), r.below ? "below" : "at most",
                     shown(r.most));
}

void check_number(const OptionRow& row, double value) {
  if (row.range.holds(value)) return;
  throw ArgumentError(ArgumentFault{
      .field = std::string(row.name), .value = shown(value), .allowed = allowed_words(row.range), .remedy = {}});
}

ArgumentError wrong_kind(const OptionRow& row, const OptionValue& value) {
  const char* wanted = "";
  switch (row.kind) {
    case OptionKind::flag:
      wanted = "yes or no";
      break;
    case OptionKind::whole:
      wanted = "a whole number";
      break;
    case OptionKind::real:
      wanted = "a number";
      break;
    case OptionKind::text:
      wanted = "a text";
      break;
    case OptionKind::choice:
      wanted = "a word";
      break;
    case OptionKind::numbers:
      wanted = "a list of numbers";
      break;
    case OptionKind::texts:
      wanted = "a list of texts";
      break;
    case OptionKind::group:
    case OptionKind::steps:
      wanted = "set by its parts";
      break;
  }
  return ArgumentError(
      ArgumentFault{.field = std::string(row.name), .value = option_words(value), .allowed = wanted, .remedy = {}});
}

ArgumentError no_choice(const OptionRow& row, std::string value) {
  return ArgumentError(ArgumentFault{.field = std::string(row.name),
                                     .value = std::move(value),
                                     .allowed = "one of " + joined(row.choices),
                                     .remedy = {}});
}

/// Value as the field stores it: words of a choice become enumerators.
OptionValue checked(const OptionRow& row, const OptionValue& value) {
  switch (row.kind) {
    case OptionKind::flag:
      if (!std::holds_alternative<bool>(value)) throw wrong_kind(row, value);
      return value;
    case OptionKind::whole:
      if (!std::holds_alternative<std::int64_t>(value)) throw wrong_kind(row, value);
      check_number(row, static_cast<double>(std::get<std::int64_t>(value)));
      return value;
    case OptionKind::real: {
      const auto* const whole = std::get_if<std::int64_t>(&value);
      if (!whole && !std::holds_alternative<double>(value)) throw wrong_kind(row, value);
      const double number = whole ? static_cast<double>(*whole) : std::get<double>(value);
      check_number(row, number);
      return number;
    }
    case OptionKind::numbers: {
      const auto* const numbers = std::get_if<std::vector<double>>(&value);
      if (!numbers) throw wrong_kind(row, value);
      if (row.count > 0 && numbers->size() != static_cast<std::size_t>(row.count))
        throw ArgumentError(ArgumentFault{.field = std::string(row.name),
                                          .value = option_words(value),
                                          .allowed = fmt::format("{} numbers", row.count),
                                          .remedy = {}});
      for (const double number : *numbers) check_number(row, number);
      return value;
    }
    case OptionKind::choice: {
      const auto* const word = std::get_if<std::string>(&value);
      if (!word) throw wrong_kind(row, value);
      const auto known = std::find(row.choices.begin(), row.choices.end(), *word);
      if (known == row.choices.end()) throw no_choice(row, "'" + printable(*word, 60) + "'");
      return static_cast<std::int64_t>(known - row.choices.begin());
    }
    case OptionKind::text:
      if (!std::holds_alternative<std::string>(value)) throw wrong_kind(row, value);
      return value;
    case OptionKind::texts:
      if (!std::holds_alternative<std::vector<std::string>>(value)) throw wrong_kind(row, value);
      return value;
    case OptionKind::group:
    case OptionKind::steps:
      break;
  }
  throw wrong_kind(row, value);
}

/// Calls `use` for every row with the struct that owns the field and the same struct with default values.
void for_each_pair(std::span<const OptionRow> rows, void* options, void* usual,
                   const std::function<void(const OptionRow&, void*, void*)>& use) {
  for (const OptionRow& row : rows)
    if (row.kind == OptionKind::group || row.kind == OptionKind::steps)
      for_each_pair(row.rows, row.part(options), row.part(usual), use);
    else
      use(row, options, usual);
}

}  // namespace

bool OptionRange::holds(double value) const {
  if (!std::isfinite(value)) return false;
  return (above ? value > least : value >= least) && (below ? value < most : value <= most);
}

std::string OptionRange::words() const {
  if (std::isinf(least) && std::isinf(most)) return "";
  if (std::isinf(most)) return above ? "above " + shown(least) : shown(least) + " or more";
  if (std::isinf(least)) return (below ? "below " : "up to ") + shown(most);
  if (!above && !below) return shown(least) + ".." + shown(most);
  return fmt::format("{} {}, {} {}", above ? "above" : "from", shown(least), below ? "below" : "up to", shown(most));
}

void for_each_option(const OptionSchema& schema, void* options,
                     const std::function<void(const OptionRow& row, void* owner)>& use) {
  for_each_pair(schema.rows, options, options, [&](const OptionRow& row, void* owner, void*) { use(row, owner); });
}

void for_each_option(const OptionSchema& schema, const void* options,
                     const std::function<void(const OptionRow& row, const void* owner)>& use) {
  // Parts are found the same way for constant and mutable structs.
  for_each_option(schema, const_cast<void*>(options), [&](const OptionRow& row, void* owner) { use(row, owner); });
}

OptionValue option_value(const OptionRow& row, const void* owner) {
  OptionValue value = row.get(owner);
  if (row.kind != OptionKind::choice || std::holds_alternative<std::monostate>(value)) return value;
  if (std::holds_alternative<std::string>(value)) return checked(row, value), value;
  if (!std::holds_alternative<std::int64_t>(value)) throw wrong_kind(row, value);
  const std::int64_t index = std::get<std::int64_t>(value);
  if (index < 0 || index >= static_cast<std::int64_t>(row.choices.size())) throw no_choice(row, std::to_string(index));
  return std::string(row.choices[static_cast<std::size_t>(index)]);
}

void set_option(const OptionRow& row, void* owner, const OptionValue& value) {
  if (std::holds_alternative<std::monostate>(value)) {
    if (!row.optional) throw wrong_kind(row, value);
    return row.set(owner, value);
  }
  try {
    row.set(owner, checked(row, value));
  } catch (const ArgumentError& error) {
    // Conversions from text do not know the name of the option.
    ArgumentFault fault = error.fault();
    if (!fault.field.empty() || fault.allowed.empty()) throw;
    fault.field = row.name;
    throw ArgumentError(fault);
  }
}

std::string option_words(const OptionValue& value) {
  struct Words {
    std::string operator()(std::monostate) const { return ""; }
    std::string operator()(bool v) const { return v ? "yes" : "no"; }
    std::string operator()(std::int64_t v) const { return std::to_string(v); }
    std::string operator()(double v) const { return shown(v); }
    std::string operator()(const std::string& v) const { return v; }
    std::string operator()(const std::vector<double>& v) const { return fmt::format("{:.12g}", fmt::join(v, ", ")); }
    std::string operator()(const std::vector<std::string>& v) const { return fmt::format("{}", fmt::join(v, ", ")); }
  };
  return std::visit(Words(), value);
}

void validate_options(const OptionSchema& schema, const void* options, const void* usual) {
  const std::vector<std::string_view> set = options_set(schema, options, usual);
  const auto is_set = [&](std::string_view name) { return std::find(set.begin(), set.end(), name) != set.end(); };
  for_each_option(schema, options, [&](const OptionRow& row, const void* owner) {
    const OptionValue value = option_value(row, owner);
    // Values that are not set need no check: a default may mean "none".
    if (!is_set(row.name) || std::holds_alternative<std::monostate>(value)) return;
    checked(row, value);
    if (!row.needs.empty() && !is_set(row.needs))
      throw ArgumentError(fmt::format("`{}` needs `{}`", row.name, row.needs));
    if (!row.excludes.empty() && is_set(row.excludes))
      throw ArgumentError(fmt::format("`{}` and `{}` exclude each other", row.name, row.excludes));
  });
}

std::vector<std::string_view> options_set(const OptionSchema& schema, const void* options, const void* usual) {
  std::vector<std::string_view> names;
  for_each_pair(schema.rows, const_cast<void*>(options), const_cast<void*>(usual),
                [&](const OptionRow& row, void* own, void* by_itself) {
                  if (row.get(own) != row.get(by_itself)) names.push_back(row.name);
                });
  return names;
}

void check_used(const std::vector<std::string_view>& set, std::span<const std::string_view> used,
                std::span<const std::string_view> some, std::string_view method) {
  for (const std::string_view name : set)
    if (std::find(some.begin(), some.end(), name) != some.end() &&
        std::find(used.begin(), used.end(), name) == used.end())
      throw ArgumentError(fmt::format("`{}` means nothing to {}", name, method));
}

}  // namespace sansmesh::inline v1
