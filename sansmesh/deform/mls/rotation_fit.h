// Optimal rotation between weighted vectors (tejada2008, 6.4; horn1987).
#pragma once

#include <array>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

using Rows3 = std::array<Vec3, 3>;  ///< a matrix by rows

inline Vec3 times(const Rows3& a, const Vec3& v) { return {dot(a[0], v), dot(a[1], v), dot(a[2], v)}; }
inline Vec3 transposed_times(const Rows3& a, const Vec3& v) { return a[0] * v.x + a[1] * v.y + a[2] * v.z; }

/// The rotation R that maximises Σ R_ij B_ij for B = Σ w p qᵀ, which rotates the q closest to the p. Its determinant is
/// +1 for any B. Of several optima it is the smallest rotation: 10⁻¹⁴ of B's norm times the identity is added to B.
/// Method: the largest root of the depressed quartic, its eigenvector by the adjugate of Horn's matrix, then Newton
/// steps on the rotations; Jacobi's method on Horn's matrix where these do not end at a certain optimum. The error is
/// that of rounding divided by the gap of the singular values, not by its square.
Rows3 best_rotation(const Rows3& b);

/// Derivative of R with respect to B: the vector ω with ∂R = R [ω]×, where `turn` is Σ ∂w q × Rᵀp.
Vec3 rotation_rate(const Rows3& b, const Rows3& r, const Vec3& turn);

/// The smallest rotation that takes unit vector a to unit vector b; between opposite vectors the axis depends on a
/// alone.
struct SmallestTurn {
  Vec3 a, b;
  Vec3 operator()(const Vec3& v) const;
  /// Derivative of operator()(v) for fixed v, with the given rates of a and b.
  Vec3 rate(const Vec3& v, const Vec3& a_rate, const Vec3& b_rate) const;
};

}  // namespace sansmesh::inline v1::detail
