// Meshes with made handles and tunnels.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "sansmesh/point_set.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::test {

/// Index of the triangle whose centre is nearest to a position.
inline std::uint32_t triangle_near(const TriangleMesh& mesh, const Vec3& x) {
  std::uint32_t best = 0;
  double least = 1e300;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    Vec3 middle;
    for (const std::uint32_t v : mesh.triangles[i]) middle += Vec3(mesh.vertices[v]) / 3;
    if (squared_norm(middle - x) < least) least = squared_norm(middle - x), best = i;
  }
  return best;
}

/// Joins the triangles nearest to two positions by a prism: a bridge outside the solid, or a tunnel through it.
inline TriangleMesh with_prism(TriangleMesh mesh, const Vec3& x, const Vec3& y) {
  const std::uint32_t first = triangle_near(mesh, x), second = triangle_near(mesh, y);
  const Triangle p = mesh.triangles[first], from = mesh.triangles[second];
  // The walls run along the second triangle in its own direction, so its corners are in the opposite order.
  Triangle q{};
  double least = 1e300;
  for (std::size_t turn = 0; turn < 3; ++turn) {
    const Triangle r{from[(turn + 1) % 3], from[turn], from[(turn + 2) % 3]};
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += squared_norm(Vec3(mesh.vertices[p[k]]) - Vec3(mesh.vertices[r[k]]));
    if (sum < least) least = sum, q = r;
  }
  for (const std::uint32_t i : {std::max(first, second), std::min(first, second)})
    mesh.triangles.erase(mesh.triangles.begin() + i);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t n = (k + 1) % 3;
    mesh.triangles.push_back({p[k], p[n], q[n]});
    mesh.triangles.push_back({p[k], q[n], q[k]});
  }
  return mesh;
}

/// m × n samples of the torus of torus_mesh(), with its normals.
inline PointSet torus_samples(std::uint32_t m, std::uint32_t n) {
  PointSet points;
  for (std::uint32_t i = 0; i < m; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const double u = 2 * std::numbers::pi * (i + 0.5 * (j % 2)) / m, v = 2 * std::numbers::pi * j / n;
      const double r = 1 + 0.35 * std::cos(v);
      points.positions.push_back(Vec3f(Vec3{r * std::cos(u), r * std::sin(u), 0.35 * std::sin(v)}));
      points.normals.push_back(Vec3f(Vec3{std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)}));
    }
  return points;
}

}  // namespace sansmesh::test
