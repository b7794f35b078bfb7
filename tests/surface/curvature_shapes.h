// Clouds with known principal curvatures (positive where convex).
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/points/normals/normals.h"
#include "sansmesh/progress.h"

namespace sansmesh::test {

struct CurvedCloud {
  PointSet points;               ///< with true normals
  std::vector<Vec3> direction1;  ///< direction of k1; zero where umbilic
  std::vector<double> k1, k2;
};

enum class Curved { sphere, torus, ellipsoid };

/// n samples uniform in area of the unit sphere, the torus of radii 1 and 0.4, or the ellipsoid of half axes 1, 0.7,
/// 0.5, displaced isotropically by Gaussian noise.
inline CurvedCloud curved_cloud(Curved shape, std::size_t n, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> unit(0, 1);
  CurvedCloud cloud;
  while (cloud.points.size() < n) {
    Vec3 x, normal, direction;
    double k1 = 1, k2 = 1;
    const Vec3 s = normalized(Vec3{gauss(random), gauss(random), gauss(random)});
    if (shape == Curved::sphere) {
      x = normal = s;
    } else if (shape == Curved::torus) {
      const double u = 2 * std::numbers::pi * unit(random), v = 2 * std::numbers::pi * unit(random);
      const double away = 1 + 0.4 * std::cos(v);
      if (unit(random) * 1.4 > away) continue;
      normal = {std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v)};
      x = Vec3{std::cos(u), std::sin(u), 0} + normal * 0.4;
      k1 = 2.5;
      k2 = std::cos(v) / away;
      direction = {-std::cos(u) * std::sin(v), -std::sin(u) * std::sin(v), std::cos(v)};
    } else {
      const double a = 1, b = 0.7, c = 0.5;
      const Vec3 gradient{s.x / a, s.y / b, s.z / c};
      const double length = norm(gradient);
      if (unit(random) / c > length) continue;
      normal = gradient / length;
      x = {s.x * a, s.y * b, s.z * c};
      const double p = a * b * c * length;
      const double gaussian = 1 / (p * p * length * length),
                   mean = (a * a + b * b + c * c - squared_norm(x)) / (2 * p * a * b * c * length * length);
      const double spread = std::sqrt(std::max(0.0, mean * mean - gaussian));
      k1 = mean + spread;
      k2 = mean - spread;
      // The shape operator is H / ‖∇‖ across the normal, H = diag(1/a², 1/b², 1/c²). This is its eigenvector of k1.
      Vec3 t, q;
      tangent_frame(normal, t, q);
      const auto form = [&](const Vec3& e, const Vec3& f) {
        return (e.x * f.x / (a * a) + e.y * f.y / (b * b) + e.z * f.z / (c * c)) / length;
      };
      if (spread > 1e-6) {
        const Vec3 first = t * form(t, q) + q * (k1 - form(t, t)), second = t * (k1 - form(q, q)) + q * form(t, q);
        direction = normalized(squared_norm(first) > squared_norm(second) ? first : second);
      }
    }
    cloud.points.positions.push_back(Vec3f(x + Vec3{gauss(random), gauss(random), gauss(random)} * noise));
    cloud.points.normals.push_back(Vec3f(normal));
    cloud.k1.push_back(k1);
    cloud.k2.push_back(k2);
    cloud.direction1.push_back(direction);
  }
  return cloud;
}

/// Replaces the normals by estimated ones with the signs of the true ones, the usual input.
inline void use_estimated_normals(PointSet& points) {
  const std::vector<Vec3f> truth = points.normals;
  Progress progress;
  estimate_normals(points, {}, progress);
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (dot(points.normals[i], truth[i]) < 0) points.normals[i] = -points.normals[i];
}

}  // namespace sansmesh::test
