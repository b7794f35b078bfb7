// Named arrays of numbers beside the positions: what files and methods know of each sample, vertex or triangle.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "sansmesh/api.h"

namespace sansmesh::inline v1 {

enum class NumberType : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

/// Bytes of one number.
inline constexpr std::size_t size_of(NumberType t) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<std::size_t>(t)];
}

inline constexpr bool is_real(NumberType t) { return t == NumberType::f32 || t == NumberType::f64; }

inline constexpr bool is_signed(NumberType t) {
  return t != NumberType::u8 && t != NumberType::u16 && t != NumberType::u32 && t != NumberType::u64;
}

/// That of a type of the language.
template <class T>
constexpr NumberType number_type_of() {
  static_assert(std::is_arithmetic_v<T> && sizeof(T) <= 8);
  if constexpr (std::is_floating_point_v<T>) return sizeof(T) == 4 ? NumberType::f32 : NumberType::f64;
  return static_cast<NumberType>(2 * std::countr_zero(sizeof(T)) + (std::is_unsigned_v<T> ? 1 : 0));
}

/// "int8", "uint8", …, "float", "double".
inline constexpr std::string_view name_of(NumberType t) {
  constexpr std::string_view names[] = {"int8",   "uint8", "int16",  "uint16", "int32",
                                        "uint32", "int64", "uint64", "float",  "double"};
  return names[static_cast<std::size_t>(t)];
}

/// The alternatives stand in the order of NumberType.
using AttributeValues =
    std::variant<std::vector<std::int8_t>, std::vector<std::uint8_t>, std::vector<std::int16_t>,
                 std::vector<std::uint16_t>, std::vector<std::int32_t>, std::vector<std::uint32_t>,
                 std::vector<std::int64_t>, std::vector<std::uint64_t>, std::vector<float>, std::vector<double>>;

/// An empty array of a type.
SANSMESH_API AttributeValues empty_values(NumberType type);

/// One array: `components` numbers a row, row after row.
struct Attribute {
  std::string name;  ///< not empty; writers turn what their format cannot hold in a name into '_'
  AttributeValues values = std::vector<float>{};
  std::size_t components = 1;  ///< at least 1

  NumberType type() const { return static_cast<NumberType>(values.index()); }
  std::size_t size() const {
    return std::visit([](const auto& v) { return v.size(); }, values);
  }
  std::size_t rows() const { return size() / components; }
  /// Number `i` (component i % components of row i / components); integers beyond 2^53 are rounded.
  double number(std::size_t i) const {
    return std::visit([i](const auto& v) { return static_cast<double>(v[i]); }, values);
  }
  /// The numbers if they are of this type; null otherwise.
  template <class T>
  const std::vector<T>* as() const {
    return std::get_if<std::vector<T>>(&values);
  }

  friend bool operator==(const Attribute&, const Attribute&) = default;
};

/// Arrays of different names and the same number of rows. Its owner says what the rows are; whatever changes these
/// calls the operations on rows below, so that all arrays follow.
///
/// Where rows are mixed, reals become weighted means. Integers are as a rule numbers of something, labels or flags, of
/// which there is no mean: they take the value of the row with the largest weight (of several, the first one), and keep
/// their type.
class SANSMESH_API AttributeTable {
 public:
  bool empty() const { return arrays_.empty(); }
  std::size_t size() const { return arrays_.size(); }  ///< number of arrays
  const Attribute& operator[](std::size_t k) const { return arrays_[k]; }
  std::vector<Attribute>::const_iterator begin() const { return arrays_.begin(); }
  std::vector<Attribute>::const_iterator end() const { return arrays_.end(); }

  /// The array of that name, or null.
  const Attribute* find(std::string_view name) const;
  /// Its numbers, or null where there is none of that name or it is of another type.
  template <class T>
  const std::vector<T>* find(std::string_view name) const {
    const Attribute* const a = find(name);
    return a ? a->as<T>() : nullptr;
  }

  /// Appends an array, or puts it in the place of the one of that name. Throws ArgumentError where the name is empty,
  /// there are no components, or the numbers are not whole rows or not as many rows as the other arrays have.
  void set(Attribute attribute);
  template <class T>
  void set(std::string name, std::vector<T> values, std::size_t components = 1) {
    set(Attribute{std::move(name), std::move(values), components});
  }
  /// Removes the array of that name; returns whether there was one.
  bool erase(std::string_view name);
  void clear() { arrays_.clear(); }

  /// Throws ArgumentError unless every array has `rows` rows; `of` names these: "points".
  void check_rows(std::size_t rows, std::string_view of) const;

  // Operations on the rows. Row numbers must exist.

  /// Removes the rows whose entry in `mask` (one for each) is not 0. Throws as check_rows.
  void remove_rows(std::span<const std::uint8_t> mask);
  /// Row i is row rows[i] of this table.
  AttributeTable taken(std::span<const std::uint32_t> rows) const;
  /// Appends a copy of a row.
  void append_copy(std::size_t row);
  /// Appends (1 − t) row a + t row b, 0 ≤ t ≤ 1.
  void append_between(std::size_t a, std::size_t b, float t);
  /// Appends these rows of another table. Arrays that it has not, or of another type or number of components, are
  /// unknown there: NaN, or 0 if they are integers. Arrays that only it has are left out.
  void append(const AttributeTable& other, std::span<const std::uint32_t> rows);
  /// Row i is Σ_j weights[k i + j] · row rows[k i + j] with j < k = `share`. Weights are ≥ 0 and sum to one for each i;
  /// where one is 0, its row does not matter.
  AttributeTable blended(std::size_t share, std::span<const std::uint32_t> rows, std::span<const double> weights) const;
  /// Row g is the mean, weighted by weight[r] > 0, of the rows r with group[r] = g: each below `groups` has some. NaN
  /// counts only where there is nothing else.
  AttributeTable means(std::span<const std::uint32_t> group, std::span<const double> weight, std::size_t groups) const;

  friend bool operator==(const AttributeTable&, const AttributeTable&) = default;

 private:
  std::vector<Attribute> arrays_;
};

/// The rows of several tables, rows[k] of table k, one after the other, with all arrays that any of them has. Where a
/// table has one not, or of another type or number of components than the first table that has it, the numbers are
/// unknown: NaN, or 0 if they are integers.
SANSMESH_API AttributeTable join_rows(std::span<const AttributeTable* const> tables, std::span<const std::size_t> rows);

/// Takes the arrays out of `a` that not every one of the `others` has with its type and number of components; returns
/// their names.
SANSMESH_API std::vector<std::string> keep_common(AttributeTable& a, std::span<const AttributeTable* const> others);

}  // namespace sansmesh::inline v1
