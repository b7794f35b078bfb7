// Systems of three linear equations.
#pragma once

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// 3×3 matrix with columns a, b, c: A x = x.x a + x.y b + x.z c. Cramer's rule takes few operations and is accurate
/// unless the determinant is small against the product of the column lengths; callers ensure that. A zero determinant
/// gives a non-finite solution.
struct Matrix3 {
  Vec3 a, b, c;

  double determinant() const { return dot(a, cross(b, c)); }

  /// Solves A x = r.
  Vec3 solve(const Vec3& r) const {
    const Vec3 bc = cross(b, c);
    return Vec3{dot(r, bc), dot(a, cross(r, c)), dot(a, cross(b, r))} / dot(a, bc);
  }

  /// Solves Aᵀ x = r: r.x, r.y, r.z are the products of x with the columns.
  Vec3 solve_transposed(const Vec3& r) const {
    const Vec3 bc = cross(b, c);
    return (bc * r.x + cross(c, a) * r.y + cross(a, b) * r.z) / dot(a, bc);
  }
};

}  // namespace sansmesh::inline v1
