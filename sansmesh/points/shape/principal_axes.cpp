#include "sansmesh/points/shape/principal_axes.h"

#include <algorithm>
#include <cmath>

namespace sansmesh::inline v1 {

PrincipalAxes principal_axes(const Symmetric3& m) {
  double a[3][3] = {{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int sweep = 0; sweep < 30; ++sweep) {
    const double off = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
    const double diagonal = a[0][0] * a[0][0] + a[1][1] * a[1][1] + a[2][2] * a[2][2];
    if (!(off > 1e-32 * diagonal)) break;
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 3; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq, a[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < 3; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk, a[q][k] = s * pk + c * qk;
        }
        for (int k = 0; k < 3; ++k) {
          const double kp = v[k][p], kq = v[k][q];
          v[k][p] = c * kp - s * kq, v[k][q] = s * kp + c * kq;
        }
      }
  }
  int order[3] = {0, 1, 2};
  std::sort(order, order + 3, [&](int i, int j) { return a[i][i] < a[j][j]; });
  PrincipalAxes result;
  for (int k = 0; k < 3; ++k) {
    const int i = order[k];
    result.values[static_cast<std::size_t>(k)] = a[i][i];
    result.axes[k] = {v[0][i], v[1][i], v[2][i]};
  }
  return result;
}

Vec3 smallest_axis(const Symmetric3& m) {
  // Trigonometric eigenvalues of the shifted, scaled matrix; then the longest cross product of two rows of A − λI.
  const double q = (m.xx + m.yy + m.zz) / 3;
  const double p1 = m.xy * m.xy + m.xz * m.xz + m.yz * m.yz;
  const double dx = m.xx - q, dy = m.yy - q, dz = m.zz - q;
  const double p = std::sqrt((dx * dx + dy * dy + dz * dz + 2 * p1) / 6);
  if (!(p > 0)) return q > 0 ? Vec3{0, 0, 1} : Vec3{};
  const double s = 1 / p;
  const double xx = dx * s, yy = dy * s, zz = dz * s, xy = m.xy * s, xz = m.xz * s, yz = m.yz * s;
  const double half_det = (xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)) / 2;
  const double angle = std::acos(std::clamp(half_det, -1.0, 1.0)) / 3;
  constexpr double kThird = 2.0943951023931954923;  // 2π/3
  const double lambda = 2 * std::cos(angle + kThird);
  const Vec3 r0{xx - lambda, xy, xz}, r1{xy, yy - lambda, yz}, r2{xz, yz, zz - lambda};
  const Vec3 c[3] = {cross(r0, r1), cross(r0, r2), cross(r1, r2)};
  const double n[3] = {squared_norm(c[0]), squared_norm(c[1]), squared_norm(c[2])};
  const int best = n[0] >= n[1] ? (n[0] >= n[2] ? 0 : 2) : (n[1] >= n[2] ? 1 : 2);
  // Nearly equal eigenvalues: rounding dominates the cross products.
  if (!(n[best] > 1e-10)) return principal_axes(m).axes[0];
  return c[best] / std::sqrt(n[best]);
}

Moments moments(std::span<const Vec3f> offsets) {
  Moments result;
  if (offsets.empty()) return result;
  for (const Vec3f& o : offsets) result.mean += Vec3(o);
  const double w = 1 / static_cast<double>(offsets.size());
  result.mean *= w;
  for (const Vec3f& o : offsets) result.covariance.add(Vec3(o) - result.mean, w);
  return result;
}

}  // namespace sansmesh::inline v1
