#include "sansmesh/dynamics/polar_rotation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/points/shape/principal_axes.h"

namespace sansmesh::inline v1 {
namespace {

/// q rotated further about its own axes by the vector w (to first order).
Turn turned_by(const Turn& q, const Vec3& w) {
  const double x = 0.5 * w.x, y = 0.5 * w.y, z = 0.5 * w.z;
  Turn r{q.w - q.x * x - q.y * y - q.z * z, q.x + q.w * x + q.y * z - q.z * y, q.y + q.w * y + q.z * x - q.x * z,
         q.z + q.w * z + q.x * y - q.y * x};
  const double scale = 1 / std::sqrt(r.w * r.w + r.x * r.x + r.y * r.y + r.z * r.z);
  return {r.w * scale, r.x * scale, r.y * scale, r.z * scale};
}

/// Ascent step where the second derivative is not negative definite: Newton's step with absolute curvatures, and away
/// from a saddle along the axis of largest gain. Zero on a ridge, which is a maximum.
Vec3 step_uphill(const std::array<Vec3, 3>& curvature, const Vec3& g, double size) {
  const auto& [x, y, z] = curvature;
  const PrincipalAxes pairs = principal_axes({x.x, y.x, z.x, y.y, z.y, z.z});
  Vec3 w;
  for (std::size_t k = 0; k < 3; ++k) {
    const double along = dot(pairs.axes[k], g), bend = std::abs(pairs.values[k]);
    if (std::abs(along) > 1e-15 * size) w += pairs.axes[k] * (along / std::max(bend, std::abs(along)));
  }
  if (squared_norm(w) < 1e-6 && pairs.values.x < -1e-14 * size) w = pairs.axes[0] * 0.7;
  return w;
}

}  // namespace

Turn nearest_turn(const Matrix3& f, const Turn& guess) {
  const double size = std::sqrt(squared_norm(f.a) + squared_norm(f.b) + squared_norm(f.c));
  if (!(size > 0) || !std::isfinite(size)) return guess;
  Turn q = guess;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const Matrix3 r = q.matrix();
    // S = Rᵀ F by columns. The trace of (R exp [w])ᵀ F is tr S + g · w − ½ wᵀ (tr S I − S) w + ….
    const Vec3 a{dot(r.a, f.a), dot(r.b, f.a), dot(r.c, f.a)};
    const Vec3 b{dot(r.a, f.b), dot(r.b, f.b), dot(r.c, f.b)};
    const Vec3 c{dot(r.a, f.c), dot(r.b, f.c), dot(r.c, f.c)};
    const Vec3 g{b.z - c.y, c.x - a.z, a.y - b.x};
    const double xy = -0.5 * (b.x + a.y), xz = -0.5 * (c.x + a.z), yz = -0.5 * (c.y + b.z);
    const double xx = b.y + c.z, yy = a.x + c.z, zz = a.x + b.y;
    // Positive definite: a maximum is near, and Newton's step ascends.
    const double minor = xx * yy - xy * xy, determinant = minor * zz - xx * yz * yz + 2 * xy * yz * xz - yy * xz * xz;
    constexpr double kLeast = 1e-13;
    const bool maximum =
        xx > kLeast * size && minor > kLeast * size * size && determinant > kLeast * size * size * size;
    Vec3 w;
    if (maximum) {
      w = Vec3{(yy * zz - yz * yz) * g.x + (xz * yz - xy * zz) * g.y + (xy * yz - xz * yy) * g.z,
               (xz * yz - xy * zz) * g.x + (xx * zz - xz * xz) * g.y + (xy * xz - xx * yz) * g.z,
               (xy * yz - xz * yy) * g.x + (xy * xz - xx * yz) * g.y + minor * g.z} /
          determinant;
    } else {
      w = step_uphill({Vec3{xx, xy, xz}, Vec3{xy, yy, yz}, Vec3{xz, yz, zz}}, g, size);
      if (squared_norm(w) == 0) return q;
    }
    const double length = norm(w);
    if (length > 1) w *= 1 / length;
    q = turned_by(q, w);
    if (maximum && length < 1e-7) break;  // quadratic convergence: the rest is rounding
  }
  return q;
}

}  // namespace sansmesh::inline v1
