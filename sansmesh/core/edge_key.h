// Unordered pairs of indices as numbers, for sorting and look-up.
#pragma once

#include <algorithm>
#include <cstdint>

namespace sansmesh::inline v1 {

/// Keys ascend by the smaller index, then by the larger.
constexpr std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}
constexpr std::uint32_t smaller_end(std::uint64_t key) { return static_cast<std::uint32_t>(key >> 32); }
constexpr std::uint32_t larger_end(std::uint64_t key) { return static_cast<std::uint32_t>(key); }

}  // namespace sansmesh::inline v1
