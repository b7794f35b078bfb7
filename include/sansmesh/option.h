// Options as data. Each options struct lists its fields once, as rows. Validation, command lines and their help, JSON
// and language bindings are derived from the rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Value of an option; monostate: not set, derived from the data.
using OptionValue = std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>,
                                 std::vector<std::string>>;

/// Type of an option's value.
enum class OptionKind : std::uint8_t {
  flag,     ///< bool
  whole,    ///< integer
  real,     ///< real number
  text,     ///< any text, or the text form of a type
  choice,   ///< one of a fixed set of words; its value is the word
  numbers,  ///< list of `count` numbers; of any length if `count` is 0
  texts,    ///< list of texts
  group,    ///< nested struct of options
  steps     ///< list of steps in execution order; its rows are the kinds of steps
};

/// Range of numbers. An excluded end can only be approached.
struct SANSMESH_API OptionRange {
  double least = -std::numeric_limits<double>::infinity();  ///< lower end
  double most = std::numeric_limits<double>::infinity();    ///< upper end
  bool above = false;                                       ///< `least` itself is excluded
  bool below = false;                                       ///< `most` itself is excluded

  /// Whether the number is finite and in the range.
  bool holds(double value) const;
  /// Returns the range as text: "1..10000", "above 0, up to 0.65", "above 0", "3 or more"; empty if unrestricted.
  std::string words() const;
};

/// All numbers above 0, or above 0 and up to `most`.
constexpr OptionRange positive(double most = std::numeric_limits<double>::infinity()) { return {0, most, true, false}; }
/// All numbers from `least` on.
constexpr OptionRange at_least(double least) { return {.least = least}; }

/// Description of an option.
struct OptionFacts {
  std::string_view text;                           ///< a sentence without its full stop; options between grave accents
  std::string_view unit = {};                      ///< "length", "degrees", "pixels", "share", "seconds", …
  std::string_view from_data = {};                 ///< value derived from the data if the option is not set
  OptionRange range = {};                          ///< range of a number, or of each number of a list
  std::span<const std::string_view> choices = {};  ///< words, in the order of the enumerators, from 0 on
  std::string_view name = {};                      ///< name, if it differs from the field's
  std::string_view negative = {};                  ///< name of a flag turned off; "no_" and its name if empty
  std::string_view negative_text = {};             ///< effect of a flag turned off, if `text` does not describe it
  std::string_view implied = {};                   ///< value if the option is given without one; may be ""
  std::string_view needs = {};                     ///< another option that this one requires
  std::string_view excludes = {};                  ///< an option that conflicts with this one
  std::span<const std::string_view> suggestions = {};  ///< suggested values of a text
  std::span<const std::string_view> endings = {};      ///< file suffixes with dots; none: all readable formats
  std::string_view old_name = {};                      ///< former name (warned of); for a default-on flag, its negative
};

/// One field of an options struct: its description, its type, and functions that read and write it. Made by option(),
/// option_group(), option_step() and option_steps().
struct OptionRow : OptionFacts {
  /// Whether the option may be given without a value: its value is then `implied`.
  bool has_implied_value() const { return implied.data() != nullptr; }

  OptionKind kind = OptionKind::flag;  ///< type of its value
  bool optional = false;               ///< may be unset: derived from the data
  bool step = false;                   ///< one of `steps`: setting it adds a step to the list
  int count = 1;                       ///< length of a list of numbers
  /// Reads the field of a struct; null for groups. Choices are numbers, or words: see option_value.
  OptionValue (*get)(const void* options) = nullptr;
  /// Writes the field of a struct without checks; null for groups. See set_option.
  void (*set)(void* options, const OptionValue& value) = nullptr;
  void* (*part)(void* options) = nullptr;  ///< struct of a group; list of steps
  std::span<const OptionRow> rows = {};    ///< rows of a group or of steps
};

/// All options of a struct.
struct OptionSchema {
  std::span<const OptionRow> rows;  ///< in display order; they live as long as the program
};

/// Schema of rows with static storage: `static constexpr OptionRow rows[] = {…}; return option_schema<rows>();`.
template <const auto& rows>
const OptionSchema& option_schema() {
  static constexpr OptionSchema schema{rows};
  return schema;
}

namespace schema_detail {

template <class T>
struct MemberOf;
template <class Owner, class T>
struct MemberOf<T Owner::*> {
  using owner = Owner;
  using type = T;
};

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

/// Name of a field or member function in the compiler's spelling.
template <auto member>
consteval std::string_view field_name_of() {
  std::string_view text = __PRETTY_FUNCTION__;
  text = text.substr(text.find("member = "));
  text = text.substr(0, text.find_first_of(";]"));
  return text.substr(text.rfind(':') + 1);
}

/// Reads and writes a field of a type; `words` are the words of its values, if it has any.
template <class T>
struct Field;
template <>
struct Field<bool> {
  static constexpr auto kind = OptionKind::flag;
  static OptionValue get(bool v) { return v; }
  static bool from(const OptionValue& v) { return std::get<bool>(v); }
};
template <class T>
requires(std::is_integral_v<T> && !std::is_same_v<T, bool>) struct Field<T> {
  static constexpr auto kind = OptionKind::whole;
  static OptionValue get(T v) { return static_cast<std::int64_t>(v); }
  static T from(const OptionValue& v) { return static_cast<T>(std::get<std::int64_t>(v)); }
};
template <class T>
requires std::is_floating_point_v<T>
struct Field<T> {
  static constexpr auto kind = OptionKind::real;
  static OptionValue get(T v) { return static_cast<double>(v); }
  static T from(const OptionValue& v) { return static_cast<T>(std::get<double>(v)); }
};
template <>
struct Field<std::string> {
  static constexpr auto kind = OptionKind::text;
  static OptionValue get(const std::string& v) { return v; }
  static std::string from(const OptionValue& v) { return std::get<std::string>(v); }
};
template <>
struct Field<std::vector<std::string>> {
  static constexpr auto kind = OptionKind::texts;
  static OptionValue get(const std::vector<std::string>& v) { return v; }
  static std::vector<std::string> from(const OptionValue& v) { return std::get<std::vector<std::string>>(v); }
};
template <>
struct Field<std::vector<double>> {
  static constexpr auto kind = OptionKind::numbers;
  static constexpr int count = 0;
  static OptionValue get(const std::vector<double>& v) { return v; }
  static std::vector<double> from(const OptionValue& v) { return std::get<std::vector<double>>(v); }
};
template <>
struct Field<Vec3> {
  static constexpr auto kind = OptionKind::numbers;
  static constexpr int count = 3;
  static OptionValue get(const Vec3& v) { return std::vector<double>{v.x, v.y, v.z}; }
  static Vec3 from(const OptionValue& v) {
    const auto& n = std::get<std::vector<double>>(v);
    return {n.at(0), n.at(1), n.at(2)};
  }
};
template <>
struct Field<Box3> {
  static constexpr auto kind = OptionKind::numbers;
  static constexpr int count = 6;
  static OptionValue get(const Box3& b) {
    return std::vector<double>{b.lower.x, b.lower.y, b.lower.z, b.upper.x, b.upper.y, b.upper.z};
  }
  static Box3 from(const OptionValue& v) {
    const auto& n = std::get<std::vector<double>>(v);
    return {{n.at(0), n.at(1), n.at(2)}, {n.at(3), n.at(4), n.at(5)}};
  }
};

/// Enumerations are numbers here; a row's `choices` converts them to words (option_value, set_option).
template <class T>
requires std::is_enum_v<T>
struct Field<T> {
  static constexpr auto kind = OptionKind::choice;
  static OptionValue get(T v) { return static_cast<std::int64_t>(v); }
  static T from(const OptionValue& v) { return static_cast<T>(std::get<std::int64_t>(v)); }
};

/// Types with a text form: text_of_option(value) and option_of_text(word, value), found by argument-dependent lookup.
/// The latter throws ArgumentError whose fault holds the value and the allowed values; set_option adds the field.
template <class T>
concept HasWords = requires(const T& value, T& to, std::string_view word) {
  { text_of_option(value) } -> std::convertible_to<std::string>;
  option_of_text(word, to);
};
template <HasWords T>
requires(!std::is_enum_v<T>) struct Field<T> {
  static constexpr auto kind = OptionKind::text;
  static OptionValue get(const T& v) { return std::string(text_of_option(v)); }
  static T from(const OptionValue& v) {
    T value;
    option_of_text(std::get<std::string>(v), value);
    return value;
  }
};
template <HasWords T>
requires(!std::is_enum_v<T>) struct Field<std::vector<T>> {
  static constexpr auto kind = OptionKind::texts;
  static OptionValue get(const std::vector<T>& v) {
    std::vector<std::string> words;
    words.reserve(v.size());
    for (const T& value : v) words.emplace_back(text_of_option(value));
    return words;
  }
  static std::vector<T> from(const OptionValue& v) {
    const auto& words = std::get<std::vector<std::string>>(v);
    std::vector<T> values(words.size());
    for (std::size_t i = 0; i < words.size(); ++i) option_of_text(words[i], values[i]);
    return values;
  }
};

template <class Words, class T>
struct ChooseField {
  using type = Words;
};
template <class T>
struct ChooseField<void, T> {
  using type = Field<T>;
};
template <class Words, class T>
using FieldOr = typename ChooseField<Words, T>::type;

}  // namespace schema_detail

/// Makes the row of a field: `option<&SmoothOptions::strength>({.text = "Step length of a round", .range =
/// positive(0.65)})`. `Words` reads and writes a field whose type has no Field: a struct with `kind`, `get` and `from`
/// as in Field.
template <auto member, class Words = void>
constexpr OptionRow option(const OptionFacts& facts) {
  using Owner = typename schema_detail::MemberOf<decltype(member)>::owner;
  using Type = typename schema_detail::MemberOf<decltype(member)>::type;
  OptionRow row;
  static_cast<OptionFacts&>(row) = facts;
  if (row.name.empty()) row.name = schema_detail::field_name_of<member>();
  if constexpr (schema_detail::IsOptional<Type>::value) {
    using F = schema_detail::FieldOr<Words, typename Type::value_type>;
    row.kind = F::kind;
    if constexpr (F::kind == OptionKind::numbers) row.count = F::count;
    row.optional = true;
    row.get = [](const void* o) -> OptionValue {
      const Type& v = static_cast<const Owner*>(o)->*member;
      return v ? F::get(*v) : OptionValue();
    };
    row.set = [](void* o, const OptionValue& value) {
      Type& v = static_cast<Owner*>(o)->*member;
      if (std::holds_alternative<std::monostate>(value))
        v.reset();
      else
        v = F::from(value);
    };
  } else {
    using F = schema_detail::FieldOr<Words, Type>;
    row.kind = F::kind;
    if constexpr (F::kind == OptionKind::numbers) row.count = F::count;
    row.get = [](const void* o) -> OptionValue { return F::get(static_cast<const Owner*>(o)->*member); };
    row.set = [](void* o, const OptionValue& value) { static_cast<Owner*>(o)->*member = F::from(value); };
  }
  return row;
}

/// Makes the rows of a nested struct. Their names are on the same level as those of the outer struct.
template <auto member>
constexpr OptionRow option_group(std::span<const OptionRow> rows, const OptionFacts& facts = {}) {
  using Owner = typename schema_detail::MemberOf<decltype(member)>::owner;
  OptionRow row;
  static_cast<OptionFacts&>(row) = facts;
  if (row.name.empty()) row.name = schema_detail::field_name_of<member>();
  row.kind = OptionKind::group;
  row.rows = rows;
  row.part = [](void* o) -> void* { return &(static_cast<Owner*>(o)->*member); };
  return row;
}

/// Makes the row of one kind of step: `make` converts a value to a step, `[](const OptionValue& value) -> Step`. The
/// value of a flag is true.
template <class Step, auto make>
constexpr OptionRow option_step(OptionKind kind, const OptionFacts& facts, int count = 1) {
  OptionRow row;
  static_cast<OptionFacts&>(row) = facts;
  row.kind = kind;
  row.count = count;
  row.optional = row.step = true;
  row.get = [](const void*) { return OptionValue(); };
  row.set = [](void* steps, const OptionValue& value) {
    static_cast<std::vector<Step>*>(steps)->push_back(make(value));
  };
  return row;
}

/// Makes the row of a list of steps, from one row per kind.
template <auto member>
constexpr OptionRow option_steps(std::span<const OptionRow> rows) {
  OptionRow row = option_group<member>(rows);
  row.kind = OptionKind::steps;
  return row;
}

/// Struct with a schema: `static const OptionSchema& schema();`.
template <class T>
concept HasSchema = requires {
  { T::schema() } -> std::convertible_to<const OptionSchema&>;
};

/// Calls `use` for every row, including the rows of groups and steps, with the struct (or list) that owns the field.
SANSMESH_API void for_each_option(const OptionSchema& schema, void* options,
                                  const std::function<void(const OptionRow& row, void* owner)>& use);
/// Same, for a constant struct.
SANSMESH_API void for_each_option(const OptionSchema& schema, const void* options,
                                  const std::function<void(const OptionRow& row, const void* owner)>& use);

/// Value of a row's field in the struct `owner`, choices as words. Throws ArgumentError if the field holds no valid
/// choice.
SANSMESH_API OptionValue option_value(const OptionRow& row, const void* owner);
/// Sets a row's field in the struct `owner` after checking kind, range and words. Converts integers to real numbers.
/// Throws ArgumentError.
SANSMESH_API void set_option(const OptionRow& row, void* owner, const OptionValue& value);
/// Formats a value: "0.6", "compact", "yes", "1, 2, 3"; empty if it is not set.
SANSMESH_API std::string option_words(const OptionValue& value);

/// Throws ArgumentError unless every value is in its range, every required option is set and no conflicting option is
/// set. `usual` is a default-constructed struct.
SANSMESH_API void validate_options(const OptionSchema& schema, const void* options, const void* usual);
/// Same, for a struct with a schema.
template <HasSchema T>
void validate_options(const T& options) {
  const T usual{};
  validate_options(T::schema(), &options, &usual);
}

/// Names of the options that differ from a default-constructed struct.
SANSMESH_API std::vector<std::string_view> options_set(const OptionSchema& schema, const void* options,
                                                       const void* usual);
/// Same, for a struct with a schema.
template <HasSchema T>
std::vector<std::string_view> options_set(const T& options) {
  const T usual{};
  return options_set(T::schema(), &options, &usual);
}

/// Throws ArgumentError if an option of `some` is set that is not in `used`. `some` are options that only some methods
/// use; `method` names the one that does not.
SANSMESH_API void check_used(const std::vector<std::string_view>& set, std::span<const std::string_view> used,
                             std::span<const std::string_view> some, std::string_view method);

}  // namespace sansmesh::inline v1
