#include "sansmesh/deform/mls/rotation_fit.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/core/simd_targets.h"
// After simd_targets.h, which defines the instruction sets of the library.
#include "sansmesh/deform/mls/rotation_lanes-inl.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kOpposite = 1e-12;  // threshold of 1 + a·b

}  // namespace

HWY_ATTR Rows3 best_rotation(const Rows3& b) {
  using One = hwy::HWY_NAMESPACE::CappedTag<double, 1>;
  const One d;
  hwy::HWY_NAMESPACE::Vec<One> from[3][3], to[3][3];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) from[i][j] = hwy::HWY_NAMESPACE::Set(d, b[i][j]);
  HWY_NAMESPACE::BestRotation(from, to);
  Rows3 r;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) r[i][j] = hwy::HWY_NAMESPACE::GetLane(to[i][j]);
  return r;
}

Vec3 rotation_rate(const Rows3& b, const Rows3& r, const Vec3& turn) {
  // ((tr S) 1 − S) ω = turn with S = RᵀB, symmetric; scaled, since B may be tiny.
  double scale = 0;
  for (const Vec3& row : b) scale = std::max({scale, std::abs(row.x), std::abs(row.y), std::abs(row.z)});
  if (!(scale > 0)) return {};
  const auto s = [&](std::size_t i, std::size_t j) {
    const auto half = [&](std::size_t k, std::size_t l) {
      return r[0][k] * (b[0][l] / scale) + r[1][k] * (b[1][l] / scale) + r[2][k] * (b[2][l] / scale);
    };
    return (half(i, j) + half(j, i)) / 2 + (i == j ? 1e-14 : 0.0);
  };
  const double s00 = s(0, 0), s11 = s(1, 1), s22 = s(2, 2), s01 = s(0, 1), s02 = s(0, 2), s12 = s(1, 2);
  const Matrix3 h{{s11 + s22, -s01, -s02}, {-s01, s22 + s00, -s12}, {-s02, -s12, s00 + s11}};
  if (!(h.determinant() > 1e-30)) return {};
  return h.solve(turn / scale);
}

Vec3 SmallestTurn::operator()(const Vec3& v) const {
  const double c = dot(a, b);
  if (1 + c < kOpposite) {
    Vec3 axis, other;
    tangent_frame(a, axis, other);
    return axis * (2 * dot(axis, v)) - v;
  }
  const Vec3 x = cross(a, b);
  const Vec3 once = cross(x, v);
  return v + once + cross(x, once) / (1 + c);
}

Vec3 SmallestTurn::rate(const Vec3& v, const Vec3& a_rate, const Vec3& b_rate) const {
  const double c = dot(a, b);
  if (1 + c < kOpposite) return {};
  const Vec3 x = cross(a, b), dx = cross(a_rate, b) + cross(a, b_rate);
  const double dc = dot(a_rate, b) + dot(a, b_rate);
  const Vec3 once = cross(x, v), d_once = cross(dx, v);
  return d_once + (cross(dx, once) + cross(x, d_once)) / (1 + c) - cross(x, once) * (dc / ((1 + c) * (1 + c)));
}

}  // namespace sansmesh::inline v1::detail
