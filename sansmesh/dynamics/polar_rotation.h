// The rotation in a deformation gradient.
#pragma once

#include <array>
#include <cmath>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A unit quaternion.
struct Turn {
  double w = 1, x = 0, y = 0, z = 0;

  /// As a matrix, by columns.
  Matrix3 matrix() const {
    return {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
            {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
            {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
  }
};

/// The rotation R for which the trace of Rᵀ F is largest: that of the polar decomposition, and of the nearest rotation
/// where F is inside out. Never a reflection. Looked for from `guess` by Newton's method on rotations; near the right
/// one a step or two. Where R is not unique (F flat, or inside out with equal stretches) one of them, near the guess.
Turn nearest_turn(const Matrix3& f, const Turn& guess);

}  // namespace sansmesh::inline v1
