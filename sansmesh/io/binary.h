// Loads numbers of any type and byte order from any address.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "sansmesh/attribute_table.h"

namespace sansmesh::inline v1::io {

static_assert(std::endian::native == std::endian::little, "the fast paths assume a little-endian machine");

/// The value at `p`, which need not be aligned; with its bytes reversed if `swap`.
template <class T, bool swap = false>
inline T load(const char* p) {
  if constexpr (swap && sizeof(T) > 1) {
    char reversed[sizeof(T)];
    for (std::size_t i = 0; i < sizeof(T); ++i) reversed[i] = p[sizeof(T) - 1 - i];
    p = reversed;
    T v;
    std::memcpy(&v, p, sizeof(T));
    return v;
  } else {
    T v;
    std::memcpy(&v, p, sizeof(T));
    return v;
  }
}

/// Function object for a type and byte order chosen at run time: at(p) loads a value.
template <class T, bool swap>
struct Loader {
  using Value = T;
  T operator()(const char* p) const { return load<T, swap>(p); }
};

/// Calls use(Loader<T, swap>{}) for `type`: one branch outside the loop instead of one inside.
template <class Use>
auto with_loader(NumberType type, bool swap, Use&& use) {
  switch (type) {
    case NumberType::i8:
      return use(Loader<std::int8_t, false>{});
    case NumberType::u8:
      return use(Loader<std::uint8_t, false>{});
    case NumberType::i16:
      return swap ? use(Loader<std::int16_t, true>{}) : use(Loader<std::int16_t, false>{});
    case NumberType::u16:
      return swap ? use(Loader<std::uint16_t, true>{}) : use(Loader<std::uint16_t, false>{});
    case NumberType::i32:
      return swap ? use(Loader<std::int32_t, true>{}) : use(Loader<std::int32_t, false>{});
    case NumberType::u32:
      return swap ? use(Loader<std::uint32_t, true>{}) : use(Loader<std::uint32_t, false>{});
    case NumberType::i64:
      return swap ? use(Loader<std::int64_t, true>{}) : use(Loader<std::int64_t, false>{});
    case NumberType::u64:
      return swap ? use(Loader<std::uint64_t, true>{}) : use(Loader<std::uint64_t, false>{});
    case NumberType::f32:
      return swap ? use(Loader<float, true>{}) : use(Loader<float, false>{});
    default:
      return swap ? use(Loader<double, true>{}) : use(Loader<double, false>{});
  }
}

inline double load_number(const char* p, NumberType type, bool swap) {
  return with_loader(type, swap, [p](auto at) { return static_cast<double>(at(p)); });
}

/// One column of a table of records: `at` is its first value, the next one is `stride` bytes further.
struct Column {
  const char* at = nullptr;
  std::size_t stride = 0;
  NumberType type = NumberType::f64;
  bool swap = false;

  explicit operator bool() const { return at != nullptr; }
  double operator[](std::size_t i) const { return load_number(at + i * stride, type, swap); }
};

}  // namespace sansmesh::inline v1::io
