// The rotation that fits best (METHODS §7.1; Horn 1987).
#pragma once

#include <array>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

using Rows3 = std::array<Vec3, 3>;  ///< a matrix by its rows

inline Vec3 times(const Rows3& a, const Vec3& v) { return {dot(a[0], v), dot(a[1], v), dot(a[2], v)}; }
inline Vec3 transposed_times(const Rows3& a, const Vec3& v) { return a[0] * v.x + a[1] * v.y + a[2] * v.z; }

/// The rotation R that maximises Σ R_ij B_ij, for B = Σ w p qᵀ: the one that turns the q closest to the p. Its
/// determinant is +1 whatever B is. Of equally good ones it is the smallest: B is pulled towards the identity by 10⁻¹⁴
/// of its norm. (Largest root of the quartic in the depressed form of METHODS, eigenvector by the adjugate of Horn's
/// matrix, steps of Newton's on the rotations; Jacobi's method on Horn's matrix where these do not end at what is
/// certainly the best: errors of rounding over the gap of the singular values, not over its square.)
Rows3 best_rotation(const Rows3& b);

/// How R turns with B: the vector ω with ∂R = R [ω]×, where `turn` is Σ ∂w q × Rᵀp.
Vec3 rotation_rate(const Rows3& b, const Rows3& r, const Vec3& turn);

/// The smallest rotation that takes unit vector a to unit vector b; between opposite ones about an axis that depends on
/// a alone.
struct SmallestTurn {
  Vec3 a, b;
  Vec3 operator()(const Vec3& v) const;
  /// Of what operator() says of a fixed v, when a and b change at these rates.
  Vec3 rate(const Vec3& v, const Vec3& a_rate, const Vec3& b_rate) const;
};

}  // namespace sansmesh::inline v1::detail
