// Types of numbers as files have them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace sansmesh {

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

}  // namespace sansmesh
