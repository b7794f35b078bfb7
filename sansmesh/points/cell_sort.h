// Sorting by cell: Morton keys and a radix sort whose cost grows with the bits in use only.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/core/parallel.h"

namespace sansmesh::detail {

/// Spreads the lower 21 bits to every third bit.
inline std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}
/// Inverse of spread_bits.
inline std::uint32_t gather_bits(std::uint64_t v) {
  v &= 0x1249249249249249;
  v = (v | v >> 2) & 0x10c30c30c30c30c3;
  v = (v | v >> 4) & 0x100f00f00f00f00f;
  v = (v | v >> 8) & 0x1f0000ff0000ff;
  v = (v | v >> 16) & 0x1f00000000ffff;
  return static_cast<std::uint32_t>((v | v >> 32) & 0x1fffff);
}
inline std::uint64_t morton_key(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2;
}

/// Sorts by the lower `bits` bits of the keys, stable, O(n · bits), parallel.
void sort_by_key(std::vector<KeyIndex>& items, int bits);

}  // namespace sansmesh::detail
