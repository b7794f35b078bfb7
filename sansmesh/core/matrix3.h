// Systems of three linear equations.
#pragma once

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The 3×3 matrix (a, b, c), by columns: A x = x.x a + x.y b + x.z c. Solved by Cramer's rule, which takes few
/// operations and is accurate as long as the determinant is not small against the product of the columns' lengths:
/// callers make sure that it is not. No determinant, no solution: then the answer is not finite.
struct Matrix3 {
  Vec3 a, b, c;

  double determinant() const { return dot(a, cross(b, c)); }

  /// x with A x = r.
  Vec3 solve(const Vec3& r) const {
    const Vec3 bc = cross(b, c);
    return Vec3{dot(r, bc), dot(a, cross(r, c)), dot(a, cross(b, r))} / dot(a, bc);
  }

  /// x with Aᵀ x = r: its products with the columns are r.x, r.y, r.z.
  Vec3 solve_transposed(const Vec3& r) const {
    const Vec3 bc = cross(b, c);
    return (bc * r.x + cross(c, a) * r.y + cross(a, b) * r.z) / dot(a, bc);
  }
};

}  // namespace sansmesh::inline v1
