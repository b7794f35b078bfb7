// Morton codes of grid cells.
#pragma once

#include <array>
#include <cstdint>

namespace sansmesh::inline v1 {
namespace detail {

/// Inserts two zeros between neighbouring bits of the low 21.
inline std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffULL;
  x = (x | x << 16) & 0x1f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

inline std::uint32_t gather_bits(std::uint64_t x) {
  x &= 0x1249249249249249ULL;
  x = (x | x >> 2) & 0x10c30c30c30c30c3ULL;
  x = (x | x >> 4) & 0x100f00f00f00f00fULL;
  x = (x | x >> 8) & 0x1f0000ff0000ffULL;
  x = (x | x >> 16) & 0x1f00000000ffffULL;
  return static_cast<std::uint32_t>((x | x >> 32) & 0x1fffff);
}

}  // namespace detail

/// Interleaves the low 21 bits of three integers, x lowest.
inline std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return detail::spread_bits(x) | detail::spread_bits(y) << 1 | detail::spread_bits(z) << 2;
}

/// Inverse of morton_code.
inline std::array<std::uint32_t, 3> morton_cell(std::uint64_t code) {
  return {detail::gather_bits(code), detail::gather_bits(code >> 1), detail::gather_bits(code >> 2)};
}

}  // namespace sansmesh::inline v1
