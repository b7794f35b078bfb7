// Approximate median of the last few numbers, as LAZ predicts differences of coordinates (isenburg2013).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace sansmesh::inline v1::io::laz {

/// Five sorted numbers. A new one replaces the largest as long as new numbers are below the median, then the smallest
/// as long as they are above it.
class RunningMedian {
 public:
  std::int32_t value() const { return sorted_[2]; }
  void add(std::int32_t v) {
    const bool drops_largest = !drops_smallest_;
    drops_smallest_ = drops_largest ? v >= sorted_[2] : v > sorted_[2];
    const std::int32_t* const kept = sorted_.data() + (drops_largest ? 0 : 1);
    const std::array<std::int32_t, 4> k = {kept[0], kept[1], kept[2], kept[3]};
    sorted_ = {std::min(k[0], v), std::max(k[0], std::min(k[1], v)), std::max(k[1], std::min(k[2], v)),
               std::max(k[2], std::min(k[3], v)), std::max(k[3], v)};
  }

 private:
  std::array<std::int32_t, 5> sorted_ = {};
  bool drops_smallest_ = false;
};

}  // namespace sansmesh::inline v1::io::laz
