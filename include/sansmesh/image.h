// Pictures and other maps of pixels, in float.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Rows from top to bottom, pixels from left to right.
template <class T>
struct PixelMap {
  int width = 0;          ///< pixels a row
  int height = 0;         ///< rows
  std::vector<T> pixels;  ///< width · height of them, row after row

  /// Without pixels.
  PixelMap() = default;
  /// w · h pixels of one value; neither may be negative.
  PixelMap(int w, int h, const T& value = {})
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}
  /// The pixel in column x, from the left, of row y, from the top, both from 0. Not checked.
  T& at(int x, int y) { return pixels[index(x, y)]; }
  /// The same of a constant map.
  const T& at(int x, int y) const { return pixels[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// sRGB with straight alpha: 0 is black or nothing, 1 white or opaque. Brighter than white is brighter than 1; files of
/// bytes hold 0..1.
using Rgba = std::array<float, 4>;
/// A picture, as read from and written to files.
using Image = PixelMap<Rgba>;
/// Distances along the rays through the middles of the pixels; infinity where nothing is.
using DepthMap = PixelMap<float>;

/// A value of 0..1 as one of the 256 levels of a byte: the nearest one, or that which is rounded up to from `threshold`
/// (above 0, up to 1) of a step on. Values beyond are clamped, NaN is 0.
inline std::uint8_t to_byte(float value, float threshold = 0.5f) {
  if (!(value > 0)) return 0;
  return static_cast<std::uint8_t>(255 * std::min(value, 1.0f) + 1 - threshold);
}

/// A colour of 0..1 as bytes.
inline std::array<std::uint8_t, 3> to_bytes(const Vec3f& color) {
  return {to_byte(color.x), to_byte(color.y), to_byte(color.z)};
}

/// The value that to_byte makes this level of.
constexpr float from_byte(std::uint8_t level) { return static_cast<float>(level) / 255; }

}  // namespace sansmesh::inline v1
