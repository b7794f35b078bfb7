// Sampled shapes with known normals.
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Samples without normals.
inline PointSet cloud(std::vector<Vec3f> positions) {
  PointSet points;
  points.positions = std::move(positions);
  return points;
}

inline Vec3f random_direction(std::mt19937& random) {
  std::normal_distribution<float> g;
  Vec3f d;
  do d = {g(random), g(random), g(random)};
  while (norm(d) < 1e-3f);
  return normalized(d);
}

/// Uniform samples of a sphere with isotropic Gaussian noise.
inline PointSet sample_sphere(std::size_t n, float radius, float noise, unsigned seed, Vec3f center = {}) {
  std::mt19937 random(seed);
  std::normal_distribution<float> g;
  PointSet points;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3f d = random_direction(random);
    points.positions.push_back(center + d * radius + Vec3f{g(random), g(random), g(random)} * noise);
    points.normals.push_back(d);
  }
  return points;
}

/// Uniform samples of the faces of a box with the given half sizes.
inline PointSet sample_box(std::size_t n, Vec3f half, unsigned seed, Vec3f center = {}) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> u(-1, 1);
  const float area[3] = {half.y * half.z, half.x * half.z, half.x * half.y};
  std::discrete_distribution<int> face({area[0], area[1], area[2]});
  PointSet points;
  for (std::size_t i = 0; i < n; ++i) {
    Vec3f p{u(random) * half.x, u(random) * half.y, u(random) * half.z}, normal;
    const auto k = static_cast<std::size_t>(face(random));
    const float side = u(random) < 0 ? -1.0f : 1.0f;
    p[k] = side * half[k];
    normal[k] = side;
    points.positions.push_back(center + p);
    points.normals.push_back(normal);
  }
  return points;
}

/// Samples of a torus, uniform in both angles.
inline PointSet sample_torus(std::size_t n, float major, float minor, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> u(0, 6.2831853f);
  PointSet points;
  for (std::size_t i = 0; i < n; ++i) {
    const float a = u(random), b = u(random);
    const Vec3f normal{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
    points.positions.push_back(Vec3f{std::cos(a), std::sin(a), 0} * major + normal * minor);
    points.normals.push_back(normal);
  }
  return points;
}

inline void append(PointSet& points, const PointSet& more) {
  points.positions.insert(points.positions.end(), more.positions.begin(), more.positions.end());
  points.normals.insert(points.normals.end(), more.normals.begin(), more.normals.end());
}

/// Flips random normals.
inline void scramble_signs(PointSet& points, unsigned seed) {
  std::mt19937 random(seed);
  for (Vec3f& n : points.normals)
    if (random() & 1) n = -n;
}

/// Fraction of normals with the correct sign.
inline double fraction_correct(const PointSet& points, const std::vector<Vec3f>& truth) {
  std::size_t correct = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) correct += dot(points.normals[i], truth[i]) > 0;
  return static_cast<double>(correct) / static_cast<double>(truth.size());
}

}  // namespace sansmesh::inline v1
