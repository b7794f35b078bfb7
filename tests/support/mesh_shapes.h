// Meshes with known measures.
#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::test {

/// Unit sphere from an octahedron split `levels` times: 8·4^levels triangles.
inline TriangleMesh octasphere(int levels) {
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)}, mesh.vertices.size());
      if (fresh) mesh.vertices.push_back(normalized(mesh.vertices[a] + mesh.vertices[b]));
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
  }
  return mesh;
}

/// Torus around z with radii 1 and 0.35, of m × n quadrilaterals.
inline TriangleMesh torus_mesh(std::uint32_t m, std::uint32_t n) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < m; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const double u = 2 * std::numbers::pi * i / m, v = 2 * std::numbers::pi * j / n, r = 1 + 0.35 * std::cos(v);
      mesh.vertices.push_back(Vec3f(Vec3{r * std::cos(u), r * std::sin(u), 0.35 * std::sin(v)}));
      const std::uint32_t a = i * n + j, b = (i + 1) % m * n + j, c = (i + 1) % m * n + (j + 1) % n,
                          d = i * n + (j + 1) % n;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

/// Adds the triangles of b to those of a, displaced.
inline TriangleMesh joined(TriangleMesh a, const TriangleMesh& b, const Vec3f& shift) {
  const auto base = static_cast<std::uint32_t>(a.vertices.size());
  for (const Vec3f& p : b.vertices) a.vertices.push_back(p + shift);
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  return a;
}

}  // namespace sansmesh::test
