// Quadric error metric of vertices that represent several planes [garland1997].
#pragma once

#include <cmath>

#include "sansmesh/core/matrix3.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Share of the quadric's trace that draws the optimum towards the edge's centroid.
constexpr double kTether = 1e-3;

/// Σ w (n·x − d)² over planes, as xᵀ A x − 2 b·x + c, and Σ w.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3 b;
  double c = 0, weight = 0;

  void add_plane(const Vec3& n, double d, double w) {
    xx += w * n.x * n.x, xy += w * n.x * n.y, xz += w * n.x * n.z;
    yy += w * n.y * n.y, yz += w * n.y * n.z, zz += w * n.z * n.z;
    b += n * (w * d);
    c += w * d * d;
    weight += w;
  }
  Quadric& operator+=(const Quadric& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    b += o.b;
    c += o.c, weight += o.weight;
    return *this;
  }
  double at(const Vec3& x) const {
    return x.x * (xx * x.x + 2 * (xy * x.y + xz * x.z)) + x.y * (yy * x.y + 2 * yz * x.z) + zz * x.z * x.z -
           2 * dot(b, x) + c;
  }
  /// Minimiser, regularised towards `tether` in directions that the planes do not determine.
  Vec3 minimum(const Vec3& tether) const {
    const double t = kTether * (xx + yy + zz);
    const double a00 = xx + t, a11 = yy + t, a22 = zz + t;
    const Vec3 r = b + tether * t;
    const Matrix3 a{{a00, xy, xz}, {xy, a11, yz}, {xz, yz, a22}};
    return std::abs(a.determinant()) > 1e-300 ? a.solve(r) : tether;
  }
};

}  // namespace sansmesh::inline v1::detail
