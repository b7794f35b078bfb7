// Pixels as bytes, as in files.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "sansmesh/image.h"

namespace sansmesh::test {

inline std::array<std::uint8_t, 4> levels(const Rgba& pixel) {
  std::array<std::uint8_t, 4> bytes;
  std::transform(pixel.begin(), pixel.end(), bytes.begin(), [](float v) { return to_byte(v); });
  return bytes;
}

/// 0..765
inline double brightness(const Image& image, int x, int y) {
  const auto p = levels(image.at(x, y));
  return p[0] + p[1] + p[2];
}

}  // namespace sansmesh::test
