// Deterministic test clouds with known truth.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "sansmesh/point_set.h"
#include "support/mesh_shapes.h"

namespace sansmesh::test {

/// n samples of the unit sphere on a Fibonacci spiral, displaced along the normal by Gaussian noise.
inline PointSet sphere(std::size_t n, double noise = 0, unsigned seed = 1) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> gauss(0, 1);
  PointSet cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1 - 2 * (static_cast<double>(i) + 0.5) / static_cast<double>(n), r = std::sqrt(1 - z * z);
    const double phi = static_cast<double>(i) * std::numbers::pi * (3 - std::sqrt(5.0));
    const Vec3 p{r * std::cos(phi), r * std::sin(phi), z};
    cloud.positions.push_back(Vec3f(p * (1 + (noise > 0 ? noise * gauss(generator) : 0))));
    cloud.normals.push_back(Vec3f(p));
  }
  return cloud;
}

/// About n samples of the surface of the cube [-1, 1]³, uniform at random.
inline PointSet cube(std::size_t n, unsigned seed = 1) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  PointSet cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t axis = i % 3;
    const float side = i / 3 % 2 ? 1.0f : -1.0f;
    Vec3f p{uniform(generator), uniform(generator), uniform(generator)}, normal;
    p[axis] = side;
    normal[axis] = side;
    cloud.positions.push_back(p);
    cloud.normals.push_back(normal);
  }
  return cloud;
}

/// n samples of a torus around z with radii 1 and 0.35.
inline PointSet torus(std::size_t n, unsigned seed = 1) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(0, 2 * std::numbers::pi), unit(0, 1);
  PointSet cloud;
  while (cloud.size() < n) {
    const double u = uniform(generator), v = uniform(generator);
    if (unit(generator) * 1.35 > 1 + 0.35 * std::cos(v)) continue;  // uniform in area
    const Vec3 normal{std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)};
    cloud.positions.push_back(Vec3f(Vec3{std::cos(u), std::sin(u), 0} + 0.35 * normal));
    cloud.normals.push_back(Vec3f(normal));
  }
  return cloud;
}

/// Both clouds, the second one scaled and then moved; with normals if the first has them.
inline PointSet joined(PointSet cloud, const PointSet& other, float scale = 1, const Vec3f& by = {}) {
  const bool with_normals = cloud.has_normals();
  for (std::size_t i = 0; i < other.size(); ++i) {
    cloud.positions.push_back(other.positions[i] * scale + by);
    if (with_normals) cloud.normals.push_back(other.normals[i]);
  }
  return cloud;
}

/// Unit sphere as a mesh without normals: an octahedron whose triangles are split in four `levels` times. 4^(levels +
/// 1) + 2 vertices.
inline PointSet ball_mesh(int levels) {
  const TriangleMesh ball = octasphere(levels);
  PointSet mesh;
  mesh.positions = ball.vertices;
  mesh.triangles = ball.triangles;
  return mesh;
}

/// Both meshes, the second one scaled and then moved.
inline PointSet joined_meshes(PointSet mesh, const PointSet& other, float scale = 1, const Vec3f& by = {}) {
  const auto first = static_cast<std::uint32_t>(mesh.size());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  return joined(std::move(mesh), other, scale, by);
}

}  // namespace sansmesh::test
