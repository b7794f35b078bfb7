// Numbers of any magnitude as numbers about 1 large: for arithmetic in float, and for squares.
#pragma once

#include <cmath>
#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The power of two by which numbers of at most `largest` (finite, >= 0) become about 1 large. It is 1 where they are
/// moderate already (2^-50..2^50, about 1e-15..1e15) or all 0: ordinary results keep every bit. 2^-1000..2^1000.
double binary_scale(double largest);

namespace detail {
double scaled_norm(const Vec3& v);
}

/// norm() also where squares overflow or vanish; the same to the bit where they do not.
inline double long_norm(const Vec3& v) {
  const double square = squared_norm(v);
  return square >= 0x1p-900 && square <= 0x1p900 ? std::sqrt(square) : detail::scaled_norm(v);
}

/// The length of a vector of any number of components, also where squares overflow or vanish.
double vector_length(std::span<const double> v);

}  // namespace sansmesh::inline v1
