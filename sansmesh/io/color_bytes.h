// Colours of any scale as bytes.
#pragma once

#include <cstdint>

#include "sansmesh/core/index_in.h"

namespace sansmesh::inline v1::io {

/// 0..255: value · scale, rounded and clamped.
inline std::uint8_t to_byte(double value, double scale) { return index_in<std::uint8_t>(value * scale + 0.5, 0, 255); }

/// Factor that brings colour values whose largest is `largest` to 0..255: they are fractions if none exceeds 1 and
/// `fractional` says that they may be, have 16 bits if some exceed 255, else 8.
inline double color_scale(double largest, bool fractional) {
  return fractional && largest <= 1.0 ? 255.0 : largest > 255.5 ? 255.0 / 65535.0 : 1.0;
}

}  // namespace sansmesh::inline v1::io
