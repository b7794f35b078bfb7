// Images and other pixel maps in float.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct ReferenceSystem;

/// Pixel map: rows from top to bottom, pixels from left to right.
template <class T>
struct PixelMap {
  int width = 0;          ///< pixels per row
  int height = 0;         ///< number of rows
  std::vector<T> pixels;  ///< width · height pixels, row by row

  /// Map without pixels.
  PixelMap() = default;
  /// Map of w · h pixels of one value; neither may be negative.
  PixelMap(int w, int h, const T& value = {})
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}
  /// Pixel in column x (from the left) of row y (from the top), both from 0. Not checked.
  T& at(int x, int y) { return pixels[index(x, y)]; }
  /// Same, for a constant map.
  const T& at(int x, int y) const { return pixels[index(x, y)]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// sRGB with straight alpha: 0 is black or transparent, 1 white or opaque. Values above 1 are brighter than white;
/// files of bytes hold 0..1.
using Rgba = std::array<float, 4>;
/// Image, as read from and written to files.
using Image = PixelMap<Rgba>;
/// Distances along the rays through the pixel centres; infinity where a ray hits nothing.
using DepthMap = PixelMap<float>;

/// Heights over x and y in square cells: a digital elevation model. The first row is the northernmost one (largest y).
struct HeightGrid {
  PixelMap<float> heights;  ///< at the centres of the cells; NaN where unknown
  double cell = 0;          ///< edge of the cells (length)
  double left = 0;          ///< x of the left border of the first column
  double top = 0;           ///< y of the upper border of the first row
  /// Reference system of the coordinates; null if unknown.
  std::shared_ptr<const ReferenceSystem> reference = {};
};

/// Quantises 0..1 to a byte: to the nearest level, or rounding up from a fraction `threshold` (above 0, up to 1) of a
/// step. Clamps other values; NaN gives 0.
inline std::uint8_t to_byte(float value, float threshold = 0.5f) {
  if (!(value > 0)) return 0;
  return static_cast<std::uint8_t>(255 * std::min(value, 1.0f) + 1 - threshold);
}

/// A colour of 0..1 as bytes.
inline std::array<std::uint8_t, 3> to_bytes(const Vec3f& color) {
  return {to_byte(color.x), to_byte(color.y), to_byte(color.z)};
}

/// Value of a level, the inverse of to_byte.
constexpr float from_byte(std::uint8_t level) { return static_cast<float>(level) / 255; }

}  // namespace sansmesh::inline v1
