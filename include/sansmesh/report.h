// Reports as data. Each report struct lists its fields once, as rows. JSON, the list of its keys and the results in
// other languages are derived from the rows.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/option.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Counts by name, for names that depend on the data.
using ReportCounts = std::vector<std::pair<std::string, std::int64_t>>;

/// Value of a row; monostate if there is none.
using ReportValue =
    std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<std::int64_t>,
                 std::vector<double>, std::vector<std::string>, std::vector<std::vector<double>>, ReportCounts>;

/// Kind of a row's value.
enum class ReportKind : std::uint8_t {
  flag,
  whole,
  real,
  text,
  choice,   ///< one of a fixed set of words
  wholes,   ///< list of integers
  numbers,  ///< list of numbers; NaN for unknown ones
  texts,
  table,   ///< list of lists of numbers: the corners of a box, the rows of a matrix
  counts,  ///< integers by name
  report,  ///< nested report, possibly absent
  reports  ///< list of reports
};

/// Description of a row.
struct ReportFacts {
  std::string_view name = {};  ///< name, if it differs from the field's: "moved.rms" is `rms` of a group `moved`
  std::string_view text = {};  ///< a sentence without its full stop
  std::string_view unit = {};  ///< "length", "degrees", "share", "s", …
  std::span<const std::string_view> choices = {};  ///< words of a choice, in the order of the enumerators
};

struct ReportRow;

/// All rows of a report struct.
struct ReportSchema {
  std::span<const ReportRow> rows;  ///< in display order; they live as long as the program
};

/// Schema of rows with static storage: `static constexpr ReportRow rows[] = {…}; return report_schema<rows>();`.
template <const auto& rows>
const ReportSchema& report_schema() {
  static constexpr ReportSchema schema{rows};
  return schema;
}

/// Called for a part of a report: a struct with a schema.
using UsePart = std::function<void(const void* part)>;

/// Field of a report, or a value derived from its fields: description, kind, and a function that reads it. Made by
/// reported(), reported_inline() and reported_base().
struct ReportRow : ReportFacts {
  ReportKind kind = ReportKind::flag;  ///< kind of its value
  bool optional = false;               ///< may be absent
  bool inlined = false;                ///< nested report whose rows are on the same level, without a name
  /// Reads the value; null for reports. Choices are numbers: see report_value.
  ReportValue (*get)(const void* report) = nullptr;
  const ReportSchema& (*part)() = nullptr;                         ///< schema of a nested report or list of reports
  void (*each)(const void* report, const UsePart& use) = nullptr;  ///< calls `use` for each nested report
};

/// Struct with a schema: `static const ReportSchema& schema();`.
template <class T>
concept HasReport = requires {
  { T::schema() } -> std::same_as<const ReportSchema&>;
};

namespace report_detail {

/// Struct that a getter reads: a member, a member function, or a stateless function.
template <class T>
struct OwnerOf {
  using type = typename OwnerOf<decltype(&T::operator())>::type;
};
template <class T, class Owner>
struct OwnerOf<T Owner::*> {
  using type = Owner;
};
template <class Lambda, class T, class Owner>
struct OwnerOf<T (Lambda::*)(const Owner&) const> {
  using type = Owner;
};

template <auto getter>
using Owner = typename OwnerOf<decltype(getter)>::type;
template <auto getter>
using ResultOf = std::remove_cvref_t<std::invoke_result_t<decltype(getter), const Owner<getter>&>>;

/// Calls a getter. For functions it calls a new object of the same type: clang mangles template arguments of unnamed
/// types alike in all sources.
template <auto getter, class T>
decltype(auto) got(const T& owner) {
  if constexpr (std::is_member_pointer_v<decltype(getter)>)
    return std::invoke(getter, owner);
  else
    return std::remove_const_t<decltype(getter)>()(owner);
}

template <class T>
struct ItemOf {};
template <class T>
struct ItemOf<std::vector<T>> {
  using type = T;
};
template <class T, std::size_t n>
struct ItemOf<std::array<T, n>> {
  using type = T;
};
template <class T>
concept IsList = requires {
  typename ItemOf<T>::type;
};
using schema_detail::IsOptional;

template <class T>
concept IsVec3 = std::same_as<T, Vec3> || std::same_as<T, Vec3f>;

inline std::vector<double> numbers_of(const Vec3& p) { return {p.x, p.y, p.z}; }

/// Kind of the values of a type.
template <class T>
constexpr ReportKind kind_of() {
  if constexpr (IsOptional<T>::value)
    return kind_of<typename T::value_type>();
  else if constexpr (std::same_as<T, bool>)
    return ReportKind::flag;
  else if constexpr (std::integral<T>)
    return ReportKind::whole;
  else if constexpr (std::floating_point<T>)
    return ReportKind::real;
  else if constexpr (std::is_enum_v<T>)
    return ReportKind::choice;
  else if constexpr (HasReport<T>)
    return ReportKind::report;
  else if constexpr (IsVec3<T>)
    return ReportKind::numbers;
  else if constexpr (std::same_as<T, Box3>)
    return ReportKind::table;
  else if constexpr (std::convertible_to<T, std::string_view>)
    return ReportKind::text;
  else if constexpr (std::same_as<T, ReportCounts>)
    return ReportKind::counts;
  else if constexpr (HasReport<typename ItemOf<T>::type>)
    return ReportKind::reports;
  else {
    constexpr ReportKind item = kind_of<typename ItemOf<T>::type>();
    return item == ReportKind::whole  ? ReportKind::wholes
           : item == ReportKind::text ? ReportKind::texts
           : item == ReportKind::real ? ReportKind::numbers
                                      : ReportKind::table;
  }
}

template <class T>
ReportValue value_of(const T& v) {
  constexpr ReportKind kind = kind_of<T>();
  if constexpr (IsOptional<T>::value) {
    return v ? value_of(*v) : ReportValue();
  } else if constexpr (kind == ReportKind::real) {
    return static_cast<double>(v);
  } else if constexpr (kind == ReportKind::flag || kind == ReportKind::counts) {
    return v;
  } else if constexpr (kind == ReportKind::whole || kind == ReportKind::choice) {
    return static_cast<std::int64_t>(v);
  } else if constexpr (kind == ReportKind::text) {
    return std::string(v);
  } else if constexpr (IsVec3<T>) {
    return numbers_of(Vec3(v));
  } else if constexpr (std::same_as<T, Box3>) {
    return v.empty() ? ReportValue() : std::vector{numbers_of(v.lower), numbers_of(v.upper)};
  } else if constexpr (kind == ReportKind::wholes) {
    return std::vector<std::int64_t>(v.begin(), v.end());
  } else if constexpr (kind == ReportKind::texts) {
    return std::vector<std::string>(v.begin(), v.end());
  } else if constexpr (kind == ReportKind::table) {
    std::vector<std::vector<double>> table;
    for (const auto& line : v) {
      using Line = std::remove_cvref_t<decltype(line)>;
      if constexpr (std::same_as<Line, Box3>)
        table.push_back({line.lower.x, line.lower.y, line.lower.z, line.upper.x, line.upper.y, line.upper.z});
      else if constexpr (IsVec3<Line>)
        table.push_back(numbers_of(Vec3(line)));
      else
        table.emplace_back(line.begin(), line.end());
    }
    return table;
  } else {
    std::vector<double> numbers;
    for (const auto& one : v) {
      if constexpr (IsOptional<std::remove_cvref_t<decltype(one)>>::value)
        numbers.push_back(one.value_or(std::numeric_limits<double>::quiet_NaN()));
      else
        numbers.push_back(one);
    }
    return numbers;
  }
}

/// Report type of a report, of an optional report, or of a list of reports.
template <class T>
struct PartOf {
  using type = T;
};
template <class T>
struct PartOf<std::optional<T>> {
  using type = T;
};
template <IsList T>
struct PartOf<T> {
  using type = typename ItemOf<T>::type;
};

template <class T>
void use_parts(const T& v, const UsePart& use) {
  if constexpr (IsOptional<T>::value) {
    if (v) use(&*v);
  } else if constexpr (IsList<T>) {
    for (const auto& one : v) use(&one);
  } else {
    use(&v);
  }
}

}  // namespace report_detail

/// Makes the row of a field: `reported<&SmoothReport::mean_edge>({.text = "Mean length of the edges", .unit =
/// "length"})`. The getter may also be a member function, or a lambda of the struct, whose row needs a name. The field
/// must belong to the struct itself, not to a base (see reported_base).
template <auto getter, class Owner = report_detail::Owner<getter>>
constexpr ReportRow reported(const ReportFacts& facts) {
  using Value = report_detail::ResultOf<getter>;
  ReportRow row;
  static_cast<ReportFacts&>(row) = facts;
  if constexpr (std::is_member_pointer_v<decltype(getter)>)
    if (row.name.empty()) row.name = schema_detail::field_name_of<getter>();
  row.kind = report_detail::kind_of<Value>();
  row.optional = schema_detail::IsOptional<Value>::value;
  if constexpr (report_detail::kind_of<Value>() == ReportKind::report ||
                report_detail::kind_of<Value>() == ReportKind::reports) {
    row.part = &report_detail::PartOf<Value>::type::schema;
    row.each = [](const void* report, const UsePart& use) {
      report_detail::use_parts<Value>(report_detail::got<getter>(*static_cast<const Owner*>(report)), use);
    };
  } else {
    row.get = [](const void* report) {
      return report_detail::value_of<Value>(report_detail::got<getter>(*static_cast<const Owner*>(report)));
    };
  }
  return row;
}

/// Includes the rows of a nested report on the same level.
template <auto getter>
constexpr ReportRow reported_inline() {
  ReportRow row = reported<getter>({});
  row.inlined = true;
  return row;
}

/// Includes the rows of a base struct on the same level.
template <class Base, class Derived>
constexpr ReportRow reported_base() {
  ReportRow row;
  row.kind = ReportKind::report;
  row.inlined = true;
  row.part = &Base::schema;
  row.each = [](const void* report, const UsePart& use) {
    use(static_cast<const Base*>(static_cast<const Derived*>(report)));
  };
  return row;
}

/// Value that is reported only under a condition.
template <class T>
std::optional<T> value_if(bool holds, T value) {
  return holds ? std::optional<T>(std::move(value)) : std::nullopt;
}

/// Value of a row, choices as words. Not for nested reports.
SANSMESH_API ReportValue report_value(const ReportRow& row, const void* report);

}  // namespace sansmesh::inline v1
