// Conversion of colours of any scale to bytes.
#pragma once

#include <cstdint>

#include "sansmesh/core/index_in.h"

namespace sansmesh::inline v1::io {

/// value · scale, rounded and clamped to 0..255.
inline std::uint8_t to_byte(double value, double scale) { return index_in<std::uint8_t>(value * scale + 0.5, 0, 255); }

/// Factor that scales colours to 0..255, where `largest` is the largest value: fractions if `fractional` is set and
/// none exceeds 1, 16 bits if some exceed 255, else 8 bits.
inline double color_scale(double largest, bool fractional) {
  return fractional && largest <= 1.0 ? 255.0 : largest > 255.5 ? 255.0 / 65535.0 : 1.0;
}

}  // namespace sansmesh::inline v1::io
