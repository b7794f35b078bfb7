#include "sansmesh/dynamics/polar_rotation.h"

#include <algorithm>

namespace sansmesh {
namespace {

/// q turned further about its own axes by (approximately, for short ones) the vector w.
Turn turned_by(const Turn& q, const Vec3& w) {
  const double x = 0.5 * w.x, y = 0.5 * w.y, z = 0.5 * w.z;
  Turn r{q.w - q.x * x - q.y * y - q.z * z, q.x + q.w * x + q.y * z - q.z * y, q.y + q.w * y + q.z * x - q.x * z,
         q.z + q.w * z + q.x * y - q.y * x};
  const double scale = 1 / std::sqrt(r.w * r.w + r.x * r.x + r.y * r.y + r.z * r.z);
  return {r.w * scale, r.x * scale, r.y * scale, r.z * scale};
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
    // Positive definite: a maximum is near, and the step leads uphill.
    const double minor = xx * yy - xy * xy, determinant = minor * zz - xx * yz * yz + 2 * xy * yz * xz - yy * xz * xz;
    const double least = 1e-6 * size;
    const bool maximum = xx > least && minor > least * least && determinant > least * least * least;
    Vec3 w;
    if (maximum) {
      w = Vec3{(yy * zz - yz * yz) * g.x + (xz * yz - xy * zz) * g.y + (xy * yz - xz * yy) * g.z,
               (xz * yz - xy * zz) * g.x + (xx * zz - xz * xz) * g.y + (xy * xz - xx * yz) * g.z,
               (xy * yz - xz * yy) * g.x + (xy * xz - xx * yz) * g.y + minor * g.z} /
          determinant;
    } else if (squared_norm(g) > 1e-18 * size * size) {
      w = g / size;  // uphill
    } else {
      // Neither slope nor maximum: leave a saddle along the axis of which turning gains most; a ridge is good enough.
      const double gain = std::min({xx, yy, zz});
      if (gain > -1e-9 * size) return q;
      w = gain == xx ? Vec3{0.7, 0.1, 0.05} : gain == yy ? Vec3{0.05, 0.7, 0.1} : Vec3{0.1, 0.05, 0.7};
    }
    const double length = norm(w);
    if (length > 1) w *= 1 / length;
    q = turned_by(q, w);
    if (maximum && length < 1e-7) break;  // quadratic: what is left is rounding
  }
  return q;
}

}  // namespace sansmesh
