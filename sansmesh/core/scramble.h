// Reproducible pseudo-random numbers.
#pragma once

#include <cstdint>

namespace sansmesh::inline v1 {

/// Finaliser of splitmix64: every bit of the result depends on all bits of x; 0 maps to 0.
constexpr std::uint64_t mixed_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// One step of splitmix64: neighbouring inputs give unrelated results.
constexpr std::uint64_t scrambled(std::uint64_t x) { return mixed_bits(x + 0x9e3779b97f4a7c15u); }

/// Uniform in [0, 1) from a counter: numbers are independent of each other.
constexpr double unit_random(std::uint64_t counter) {
  return static_cast<double>(scrambled(counter * 0x9e3779b97f4a7c15u) >> 11) * 0x1p-53;
}

}  // namespace sansmesh::inline v1
