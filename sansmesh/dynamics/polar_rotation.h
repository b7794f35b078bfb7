// Rotation of a deformation gradient by polar decomposition.
#pragma once

#include "sansmesh/core/matrix3.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A unit quaternion.
struct Turn {
  double w = 1, x = 0, y = 0, z = 0;

  /// Rotation matrix, by columns.
  Matrix3 matrix() const {
    return {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
            {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
            {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
  }
};

/// The rotation R that maximises the trace of Rᵀ F: that of the polar decomposition or, where F is inverted, the
/// nearest rotation. Never a reflection. Newton's method on rotations starts from `guess`; near the solution it takes
/// one or two steps. If R is not unique (F flat, or inverted with equal stretches), returns one near the guess.
Turn nearest_turn(const Matrix3& f, const Turn& guess);

}  // namespace sansmesh::inline v1
