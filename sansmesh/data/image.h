// An 8-bit RGBA picture.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace sansmesh {

/// Rows from top to bottom, pixels from left to right, sRGB with straight alpha.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::array<std::uint8_t, 4>> pixels;

  Image() = default;
  Image(int w, int h) : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  std::array<std::uint8_t, 4>& at(int x, int y) { return pixels[static_cast<std::size_t>(y) * width + x]; }
  const std::array<std::uint8_t, 4>& at(int x, int y) const { return pixels[static_cast<std::size_t>(y) * width + x]; }
};

}  // namespace sansmesh
