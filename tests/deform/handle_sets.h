// Handles for tests, and finite differences to compare derivatives with.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "sansmesh/deform/mls/mls_deformation.h"

namespace sansmesh::test {

using Deform = std::function<Vec3(const Vec3&)>;

inline std::vector<Vec3> random_places(std::size_t n, unsigned seed, double spread = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-spread, spread);
  std::vector<Vec3> x(n);
  for (Vec3& p : x) p = {u(random), u(random), u(random)};
  return x;
}

/// n handles in −1..1 after the deformation, with sources given by `source`.
inline std::vector<Handle> handles_from(std::size_t n, const Deform& source, unsigned seed = 1) {
  std::vector<Handle> handles;
  for (const Vec3& q : random_places(n, seed)) {
    Handle h;
    h.q = q, h.p = source(q);
    handles.push_back(h);
  }
  return handles;
}

/// Handles with random displacements of some tenths.
inline std::vector<Handle> loose_handles(std::size_t n, unsigned seed = 1, double way = 0.3) {
  const std::vector<Vec3> ways = random_places(n, seed + 1000, way);
  std::vector<Handle> handles = handles_from(
      n, [](const Vec3& q) { return q; }, seed);
  for (std::size_t i = 0; i < n; ++i) handles[i].p += ways[i];
  return handles;
}

/// v rotated by an angle about an axis of any length.
inline Vec3 turned(const Vec3& v, const Vec3& axis, double angle) {
  const Vec3 e = normalized(axis);
  return v * std::cos(angle) + cross(e, v) * std::sin(angle) + e * (dot(e, v) * (1 - std::cos(angle)));
}

inline MlsDeformationOptions of_kind(DeformationKind kind, int degree = 2, double alpha = 1) {
  MlsDeformationOptions options;
  options.kind = kind, options.degree = degree, options.alpha = alpha;
  return options;
}

inline std::vector<MlsDeformationOptions> all_kinds(double alpha = 1) {
  return {of_kind(DeformationKind::affine, 2, alpha), of_kind(DeformationKind::similarity, 2, alpha),
          of_kind(DeformationKind::rigid, 2, alpha), of_kind(DeformationKind::nonlinear, 2, alpha),
          of_kind(DeformationKind::nonlinear, 3, alpha)};
}

inline std::vector<Vec3> mapped(const SpaceMap& map, const std::vector<Vec3>& x) {
  std::vector<Vec3> y(x.size());
  map.map(x, {y, {}, {}, {}});
  return y;
}

inline std::vector<Jacobian> jacobians(const SpaceMap& map, const std::vector<Vec3>& x) {
  std::vector<Jacobian> j(x.size());
  map.map(x, {{}, j, {}, {}});
  return j;
}

/// Largest distance from the positions given by `source`.
inline double largest_error(const SpaceMap& map, const std::vector<Vec3>& x, const Deform& source) {
  const std::vector<Vec3> y = mapped(map, x);
  double most = 0;
  for (std::size_t i = 0; i < x.size(); ++i) most = std::max(most, norm(y[i] - source(x[i])));
  return most;
}

/// Largest difference between a derivative and the fourth-order difference, relative to its size.
inline double jacobian_error(const SpaceMap& map, const std::vector<Vec3>& x, double step) {
  const std::vector<Jacobian> j = jacobians(map, x);
  double most = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<Vec3> around(4, x[i]);
      for (std::size_t s = 0; s < 4; ++s)
        around[s][k] += step * (s < 2 ? static_cast<double>(s) - 2 : static_cast<double>(s) - 1);
      const std::vector<Vec3> y = mapped(map, around);
      const Vec3 slope = (y[0] - y[3] + (y[2] - y[1]) * 8) / (12 * step);
      most = std::max(most, norm(slope - j[i][k]) / (1 + norm(slope)));
    }
  }
  return most;
}

}  // namespace sansmesh::test
