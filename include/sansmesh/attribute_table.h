// Named numeric arrays of the samples of a cloud, or of the vertices or triangles of a mesh.
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

/// Type of the numbers of an array: integer or floating point, and number of bits.
enum class NumberType : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

/// Size of one number in bytes.
inline constexpr std::size_t size_of(NumberType t) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<std::size_t>(t)];
}

/// True for float and double.
inline constexpr bool is_real(NumberType t) { return t == NumberType::f32 || t == NumberType::f64; }

/// True for types with negative numbers: signed integers, float and double.
inline constexpr bool is_signed(NumberType t) {
  return t != NumberType::u8 && t != NumberType::u16 && t != NumberType::u32 && t != NumberType::u64;
}

/// NumberType of an arithmetic type of at most 8 bytes.
template <class T>
constexpr NumberType number_type_of() {
  static_assert(std::is_arithmetic_v<T> && sizeof(T) <= 8);
  if constexpr (std::is_floating_point_v<T>) return sizeof(T) == 4 ? NumberType::f32 : NumberType::f64;
  return static_cast<NumberType>(2 * std::countr_zero(sizeof(T)) + (std::is_unsigned_v<T> ? 1 : 0));
}

/// Name of a type: "int8", "uint8", …, "float", "double".
inline constexpr std::string_view name_of(NumberType t) {
  constexpr std::string_view names[] = {"int8",   "uint8", "int16",  "uint16", "int32",
                                        "uint32", "int64", "uint64", "float",  "double"};
  return names[static_cast<std::size_t>(t)];
}

/// Numbers of an array of any type. The alternatives are in the order of NumberType.
using AttributeValues =
    std::variant<std::vector<std::int8_t>, std::vector<std::uint8_t>, std::vector<std::int16_t>,
                 std::vector<std::uint16_t>, std::vector<std::int32_t>, std::vector<std::uint32_t>,
                 std::vector<std::int64_t>, std::vector<std::uint64_t>, std::vector<float>, std::vector<double>>;

/// Returns an empty array of a type.
SANSMESH_API AttributeValues empty_values(NumberType type);

/// One array, stored row by row with `components` numbers per row.
struct Attribute {
  std::string name;  ///< not empty; writers replace characters that their format cannot hold by '_'
  AttributeValues values = std::vector<float>{};  ///< rows() · `components` numbers
  std::size_t components = 1;                     ///< numbers per row, at least 1

  /// Type of the numbers.
  NumberType type() const { return static_cast<NumberType>(values.index()); }
  /// Number of all numbers.
  std::size_t size() const {
    return std::visit([](const auto& v) { return v.size(); }, values);
  }
  /// Number of rows.
  std::size_t rows() const { return size() / components; }
  /// Number `i` (component i % components of row i / components). Integers beyond 2^53 are rounded.
  double number(std::size_t i) const {
    return std::visit([i](const auto& v) { return static_cast<double>(v[i]); }, values);
  }
  /// Numbers of this type; null if the array has another type.
  template <class T>
  const std::vector<T>* as() const {
    return std::get_if<std::vector<T>>(&values);
  }

  /// Whether name, type, components and numbers are equal; NaN equals nothing.
  friend bool operator==(const Attribute&, const Attribute&) = default;
};

/// Arrays with different names and the same number of rows. The owner defines the meaning of the rows; code that
/// changes rows calls the row operations below, so that all arrays stay consistent.
///
/// Combining rows takes weighted means of real numbers. Integers are usually identifiers, labels or flags, which have
/// no mean: they take the value of the row with the largest weight (the first of several) and keep their type.
class SANSMESH_API AttributeTable {
 public:
  /// Whether there are no arrays.
  bool empty() const { return arrays_.empty(); }
  std::size_t size() const { return arrays_.size(); }  ///< number of arrays
  /// Array `k`, below size(), in the order of insertion.
  const Attribute& operator[](std::size_t k) const { return arrays_[k]; }
  /// First array.
  std::vector<Attribute>::const_iterator begin() const { return arrays_.begin(); }
  /// End of the arrays.
  std::vector<Attribute>::const_iterator end() const { return arrays_.end(); }

  /// Array with that name, or null. Valid until the table changes.
  const Attribute* find(std::string_view name) const;
  /// Numbers of the array with that name, or null if there is none or it has another type.
  template <class T>
  const std::vector<T>* find(std::string_view name) const {
    const Attribute* const a = find(name);
    return a ? a->as<T>() : nullptr;
  }

  /// Appends an array, or replaces the array with its name. Throws ArgumentError if the name is empty, there are no
  /// components, the last row is incomplete, or the number of rows differs from that of the other arrays.
  void set(Attribute attribute);
  /// Same, from name, numbers and components.
  template <class T>
  void set(std::string name, std::vector<T> values, std::size_t components = 1) {
    set(Attribute{std::move(name), std::move(values), components});
  }
  /// Removes the array with that name; returns whether there was one.
  bool erase(std::string_view name);
  /// Removes all arrays.
  void clear() { arrays_.clear(); }

  /// Throws ArgumentError unless every array has `rows` rows; `of` names the rows: "points".
  void check_rows(std::size_t rows, std::string_view of) const;

  // Row operations. Row numbers must exist.

  /// Removes the rows whose `mask` entry (one per row) is not 0. Throws as check_rows.
  void remove_rows(std::span<const std::uint8_t> mask);
  /// Returns the table whose row i is row rows[i] of this one.
  AttributeTable taken(std::span<const std::uint32_t> rows) const;
  /// Appends a copy of a row.
  void append_copy(std::size_t row);
  /// Appends (1 − t) row a + t row b, 0 ≤ t ≤ 1.
  void append_between(std::size_t a, std::size_t b, float t);
  /// Appends these rows of another table. Arrays missing there, or with another type or number of components, become
  /// NaN (0 for integers). Arrays that only the other table has are ignored.
  void append(const AttributeTable& other, std::span<const std::uint32_t> rows);
  /// Row i is Σ_j weights[k i + j] · row rows[k i + j] with j < k = `share`. Weights are ≥ 0 and sum to 1 for each i; a
  /// row with weight 0 has no effect.
  AttributeTable blended(std::size_t share, std::span<const std::uint32_t> rows, std::span<const double> weights) const;
  /// Row g is the mean of the rows r with group[r] = g, weighted by weight[r] > 0. Each group below `groups` has at
  /// least one row. NaN counts only if a group has no other value.
  AttributeTable means(std::span<const std::uint32_t> group, std::span<const double> weight, std::size_t groups) const;

  /// True if all arrays are equal and in the same order.
  friend bool operator==(const AttributeTable&, const AttributeTable&) = default;

 private:
  std::vector<Attribute> arrays_;
};

/// Concatenates the rows of several tables, rows[k] rows of table k, with the union of their arrays. If a table lacks
/// an array, or has it with another type or number of components than the first table with that array, its numbers
/// become NaN (0 for integers).
SANSMESH_API AttributeTable join_rows(std::span<const AttributeTable* const> tables, std::span<const std::size_t> rows);

/// Removes from `a` the arrays that not all `others` have with the same type and number of components; returns their
/// names.
SANSMESH_API std::vector<std::string> keep_common(AttributeTable& a, std::span<const AttributeTable* const> others);

}  // namespace sansmesh::inline v1
