// Local shapes of multi-level partition of unity implicits: quadrics, alone or combined at an edge or a corner.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// q(x) = xᵀ A x + b·x + c, x relative to the centre of the quadric; A is symmetric.
struct QuadricPiece {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3 b;
  double c = 0;

  /// A x
  Vec3 times(const Vec3& x) const {
    return {xx * x.x + xy * x.y + xz * x.z, xy * x.x + yy * x.y + yz * x.z, xz * x.x + yz * x.y + zz * x.z};
  }
  double value(const Vec3& x) const { return dot(x, times(x) + b) + c; }
  Vec3 gradient(const Vec3& x) const { return times(x) * 2.0 + b; }

  /// A += s u uᵀ
  void add_square(const Vec3& u, double s) {
    xx += s * u.x * u.x, xy += s * u.x * u.y, xz += s * u.x * u.z;
    yy += s * u.y * u.y, yz += s * u.y * u.z, zz += s * u.z * u.z;
  }
  /// A += s (u vᵀ + v uᵀ)
  void add_product(const Vec3& u, const Vec3& v, double s) {
    xx += 2 * s * u.x * v.x, yy += 2 * s * u.y * v.y, zz += 2 * s * u.z * v.z;
    xy += s * (u.x * v.y + v.x * u.y), xz += s * (u.x * v.z + v.x * u.z), yz += s * (u.y * v.z + v.y * u.z);
  }
  /// The same function for points relative to another centre: x + by there is x here.
  QuadricPiece seen_from(const Vec3& by) const {
    QuadricPiece q = *this;
    q.b = gradient(by), q.c = value(by);
    return q;
  }
  /// Frobenius norm of A, at least its largest absolute eigenvalue.
  double hessian_norm() const { return std::sqrt(xx * xx + yy * yy + zz * zz + 2 * (xy * xy + xz * xz + yz * yz)); }
};

/// Largest number of quadrics that meet at an edge or a corner.
inline constexpr std::size_t kMostPieces = 4;

/// Combination of the pieces of a shape into one function, by maxima (intersection of solids) and minima (union).
struct PieceCombination {
  std::uint8_t pieces = 1;  ///< 1..kMostPieces
  std::uint8_t maxima = 0;  ///< bit k: step k takes the maximum
  /// 1: of four pieces, step 0 joins 0 and 1, step 1 joins 2 and 3, step 2 both results; 0: step k joins the result so
  /// far with piece k + 1.
  std::uint8_t in_pairs = 0;

  bool larger(unsigned step) const { return (maxima >> step & 1) != 0; }

  /// Applies `join(step is a maximum, a, b)` to the values of the pieces.
  template <class T, class Join>
  T combine(const std::array<T, kMostPieces>& v, Join&& join) const {
    if (in_pairs != 0) return join(larger(2), join(larger(0), v[0], v[1]), join(larger(1), v[2], v[3]));
    T all = v[0];
    for (unsigned k = 1; k < pieces; ++k) all = join(larger(k - 1), all, v[k]);
    return all;
  }
};

/// A local approximation, in coordinates relative to the centre of its ball.
struct LocalShape {
  std::array<QuadricPiece, kMostPieces> pieces;
  PieceCombination combination;
};

/// Value of a combination at x, and the piece that it comes from.
struct ShapeValue {
  double value;
  std::uint32_t piece;
};

inline ShapeValue shape_value(const QuadricPiece* pieces, PieceCombination how, const Vec3& x) {
  if (how.pieces == 1) return {pieces[0].value(x), 0};
  std::array<ShapeValue, kMostPieces> v{};
  for (std::uint32_t k = 0; k < how.pieces; ++k) v[k] = {pieces[k].value(x), k};
  return how.combine(v, [](bool larger, const ShapeValue& a, const ShapeValue& b) {
    return (larger ? b.value > a.value : b.value < a.value) ? b : a;
  });
}

/// Bounds of the values within `radius` of x.
ValueRange shape_range(const QuadricPiece* pieces, PieceCombination how, const Vec3& x, double radius);

/// Largest |Q| / ‖∇Q‖ at points relative to the centre (ohtake2003, section 4): their distance from the zero set, to
/// first order.
double shape_error(const LocalShape& shape, std::span<const Vec3> x);

}  // namespace sansmesh::inline v1
