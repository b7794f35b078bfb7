// Options as data. Each options struct lists its fields once, as rows; validation, command lines and their help, JSON
// and the bindings of other languages are made from the rows.
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

/// The value of any option. Nothing: it is not set, and follows from the data.
using OptionValue = std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>,
                                 std::vector<std::string>>;

/// Type of an option's value.
enum class OptionKind : std::uint8_t {
  flag,     ///< bool
  whole,    ///< a whole number
  real,     ///< a real number
  text,     ///< any text, or one of a type that has words for its values
  choice,   ///< one of a few words; its value is the word
  numbers,  ///< a list of `count` numbers, or of any number of them where that is 0
  texts,    ///< a list of texts
  group,    ///< a struct of options
  steps     ///< a list of steps, done one after the other; its rows are the kinds of steps
};

/// Numbers that an option takes. An end that is excluded is approached only.
struct SANSMESH_API OptionRange {
  double least = -std::numeric_limits<double>::infinity();  ///< lower end
  double most = std::numeric_limits<double>::infinity();    ///< upper end
  bool above = false;                                       ///< `least` itself is excluded
  bool below = false;                                       ///< `most` itself is excluded

  /// Whether the number is finite and lies in the range.
  bool holds(double value) const;
  /// The range in words: "1..10000", "above 0, up to 0.65", "above 0", "3 or more"; empty if any number is taken.
  std::string words() const;
};

/// All numbers above 0, or above 0 and up to `most`.
constexpr OptionRange positive(double most = std::numeric_limits<double>::infinity()) { return {0, most, true, false}; }
/// `least` and more.
constexpr OptionRange at_least(double least) { return {.least = least}; }

/// What is said of an option besides its field.
struct OptionFacts {
  std::string_view text;            ///< a sentence without its full stop; options stand between grave accents
  std::string_view unit = {};       ///< "length", "degrees", "pixels", "share", "seconds", …
  std::string_view from_data = {};  ///< what is chosen where the option is not set
  OptionRange range = {};           ///< of numbers, each of them
  std::span<const std::string_view> choices = {};      ///< the words, in the order of the enumerators, from 0 on
  std::string_view name = {};                          ///< where it is not the field's
  std::string_view negative = {};                      ///< of flags: its name turned off; "no_" and its name if empty
  std::string_view negative_text = {};                 ///< of flags: what it does turned off, where `text` is not that
  std::string_view implied = {};                       ///< its value where it is named without one; "" is one, too
  std::string_view needs = {};                         ///< an option without which this one means nothing
  std::string_view excludes = {};                      ///< an option that cannot be set as well
  std::span<const std::string_view> usual_words = {};  ///< of a text: some that it may be, to be offered
  std::span<const std::string_view> endings = {};      ///< of a file (unit "file"), with dots; none: whatever is read
  std::string_view old_name = {};  ///< that it had, understood and warned of; a flag that is on by itself: turned off
};

/// One field of an options struct: what is said of it, its type, and how it is read and written. Made by option(),
/// option_group(), option_step() and option_steps().
struct OptionRow : OptionFacts {
  /// Whether it may be named without a value: `implied` is then its value.
  bool may_stand_alone() const { return implied.data() != nullptr; }

  OptionKind kind = OptionKind::flag;  ///< type of its value
  bool optional = false;               ///< may be left to the data
  bool step = false;                   ///< one of `steps`: setting it adds a step to the list
  int count = 1;                       ///< of numbers
  /// Reads the field of a struct; null for groups. Choices come as numbers, or as words: see option_value.
  OptionValue (*get)(const void* options) = nullptr;
  /// Writes the field of a struct, without any check; null for groups. See set_option.
  void (*set)(void* options, const OptionValue& value) = nullptr;
  void* (*part)(void* options) = nullptr;  ///< of a group: the struct; of steps: the list
  std::span<const OptionRow> rows = {};    ///< of a group or steps
};

/// All options of a struct.
struct OptionSchema {
  std::span<const OptionRow> rows;  ///< in the order in which they are told; they live as long as the program
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

/// The name of a field or member function, as the compiler spells it.
template <auto member>
consteval std::string_view field_name_of() {
  std::string_view text = __PRETTY_FUNCTION__;
  text = text.substr(text.find("member = "));
  text = text.substr(0, text.find_first_of(";]"));
  return text.substr(text.rfind(':') + 1);
}

/// How a field of a type is read and written; where words stand for values, `words` are they.
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

/// Enumerations are read as numbers here; a row's `choices` makes them words (option_value, set_option).
template <class T>
requires std::is_enum_v<T>
struct Field<T> {
  static constexpr auto kind = OptionKind::choice;
  static OptionValue get(T v) { return static_cast<std::int64_t>(v); }
  static T from(const OptionValue& v) { return static_cast<T>(std::get<std::int64_t>(v)); }
};

/// Types that have words for their values: text_of_option(value) and option_of_text(word, value), found by their
/// namespace. The latter throws ArgumentError whose fault has value and what is allowed; set_option adds the field.
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

/// The row of a field, `option<&SmoothOptions::strength>({.text = "How far a round goes", .range = positive(0.65)})`.
/// `Words` reads and writes a field whose type does not tell how: a struct with `kind`, `get` and `from` as Field has
/// them.
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

/// The rows of a struct within a struct. Their names stand beside those of the outer one.
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

/// The row of one kind of step: `make` makes a step of a value, `[](const OptionValue& value) -> Step`. The value of a
/// flag is true.
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

/// A list of steps; a row for each kind.
template <auto member>
constexpr OptionRow option_steps(std::span<const OptionRow> rows) {
  OptionRow row = option_group<member>(rows);
  row.kind = OptionKind::steps;
  return row;
}

/// A struct with a schema: `static const OptionSchema& schema();`.
template <class T>
concept HasSchema = requires {
  { T::schema() } -> std::convertible_to<const OptionSchema&>;
};

/// Calls `use` for every row, those of groups and steps in their place, with the struct (or list) that it is a field
/// of.
SANSMESH_API void for_each_option(const OptionSchema& schema, void* options,
                                  const std::function<void(const OptionRow& row, void* owner)>& use);
/// The same of a constant struct.
SANSMESH_API void for_each_option(const OptionSchema& schema, const void* options,
                                  const std::function<void(const OptionRow& row, const void* owner)>& use);

/// Value of a row's field in the struct `owner`, choices as words. Throws ArgumentError for what is none of these.
SANSMESH_API OptionValue option_value(const OptionRow& row, const void* owner);
/// Sets a row's field in the struct `owner`: checks kind, range and words. Whole numbers are taken for real ones.
/// Throws ArgumentError.
SANSMESH_API void set_option(const OptionRow& row, void* owner, const OptionValue& value);
/// A value in words: "0.6", "compact", "yes", "1, 2, 3"; empty if it is not set.
SANSMESH_API std::string option_words(const OptionValue& value);

/// Throws ArgumentError unless every value lies in its range, needs what is set and excludes what is set. `usual` is a
/// default-constructed struct.
SANSMESH_API void validate_options(const OptionSchema& schema, const void* options, const void* usual);
/// The same of a struct with a schema.
template <HasSchema T>
void validate_options(const T& options) {
  const T usual{};
  validate_options(T::schema(), &options, &usual);
}

/// Names of the options that differ from those of a default-constructed struct.
SANSMESH_API std::vector<std::string_view> options_set(const OptionSchema& schema, const void* options,
                                                       const void* usual);
/// The same of a struct with a schema.
template <HasSchema T>
std::vector<std::string_view> options_set(const T& options) {
  const T usual{};
  return options_set(T::schema(), &options, &usual);
}

/// Throws ArgumentError if an option is set that is none of `used` and one of `some`: options that mean something to
/// some methods only. `method` is the one that does not use it.
SANSMESH_API void check_used(const std::vector<std::string_view>& set, std::span<const std::string_view> used,
                             std::span<const std::string_view> some, std::string_view method);

}  // namespace sansmesh::inline v1
