// Colours of any scale as bytes.
#pragma once

#include <cstdint>

namespace sansmesh::io {

/// 0..255: value · scale, rounded and clamped.
inline std::uint8_t to_byte(double value, double scale) {
  const double v = value * scale + 0.5;
  return static_cast<std::uint8_t>(v >= 255 ? 255 : v > 0 ? v : 0);
}

/// Factor that brings colour values whose largest is `largest` to 0..255: they are fractions if none exceeds 1 and
/// `fractional` says that they may be, have 16 bits if some exceed 255, else 8.
inline double color_scale(double largest, bool fractional) {
  return fractional && largest <= 1.0 ? 255.0 : largest > 255.5 ? 255.0 / 65535.0 : 1.0;
}

}  // namespace sansmesh::io
