// Scales numbers to order 1, so that float arithmetic and squares do not overflow.
#pragma once

#include <cmath>
#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Returns the power of two that scales numbers of at most `largest` (finite, >= 0) to order 1, from 2^-1000 to 2^1000.
/// Returns 1 for moderate numbers (2^-50..2^50, about 1e-15..1e15) and for 0, so that ordinary results keep every bit.
double binary_scale(double largest);

namespace detail {
double scaled_norm(const Vec3& v);
}

/// norm() without overflow or underflow of squares; bit-identical to norm() where neither occurs.
inline double safe_norm(const Vec3& v) {
  const double square = squared_norm(v);
  return square >= 0x1p-900 && square <= 0x1p900 ? std::sqrt(square) : detail::scaled_norm(v);
}

/// Length of a vector with any number of components, without overflow or underflow of squares.
double vector_length(std::span<const double> v);

}  // namespace sansmesh::inline v1
