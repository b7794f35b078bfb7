// Exact closed meshes of flat faces that meet at edges of many angles, convex and concave.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::test {

/// The cube [-1, 1]³.
inline TriangleMesh cube_of_faces() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Regular icosahedron with vertices at distance 1: blunt edges, where normals turn by 41.8°.
inline TriangleMesh icosahedron() {
  const double phi = std::numbers::phi, size = std::hypot(1.0, phi);
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double a : {-1.0, 1.0})
      for (const double b : {-phi, phi}) {
        Vec3 v;
        v[static_cast<std::size_t>(axis)] = 0;
        v[static_cast<std::size_t>((axis + 1) % 3)] = a / size;
        v[static_cast<std::size_t>((axis + 2) % 3)] = b / size;
        mesh.vertices.emplace_back(v);
      }
  // Faces are the triples of neighbouring vertices, 2 / √(1 + φ²) apart.
  const auto near = [&](std::uint32_t i, std::uint32_t j) {
    return std::abs(static_cast<double>(norm(mesh.vertices[i] - mesh.vertices[j])) - 2 / size) < 1e-5;
  };
  for (std::uint32_t i = 0; i < 12; ++i)
    for (std::uint32_t j = i + 1; j < 12; ++j)
      for (std::uint32_t k = j + 1; k < 12; ++k) {
        if (!near(i, j) || !near(j, k) || !near(k, i)) continue;
        const Vec3f a = mesh.vertices[i], b = mesh.vertices[j], c = mesh.vertices[k];
        const bool outward = dot(cross(b - a, c - a), a + b + c) > 0;
        mesh.triangles.push_back(outward ? Triangle{i, j, k} : Triangle{i, k, j});
      }
  return mesh;
}

/// Profile in x and y, swept along z from 0 to 1. At its edges normals turn by 30°, 45°, 60°, 90°, 106° and 134°, and
/// by 45° and 60° in the opposite direction: a notch.
inline TriangleMesh swept_profile() {
  constexpr std::array<std::array<double, 2>, 8> outline{
      {{0, 0}, {1.4, 0}, {1.9, 0.29}, {1.9, 0.95}, {1.35, 0.95}, {1.0, 0.6}, {0.55, 0.6}, {0.3, 1.03}}};
  const auto n = static_cast<std::uint32_t>(outline.size());
  TriangleMesh mesh;
  for (const float z : {0.0f, 1.0f})
    for (const auto& [x, y] : outline) mesh.vertices.push_back({static_cast<float>(x), static_cast<float>(y), z});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.push_back({i, j, j + n});
    mesh.triangles.push_back({i, j + n, i + n});
  }
  // Counter-clockwise triangles of the outline.
  for (const auto& [a, b, c] : {Triangle{0, 6, 7}, {0, 5, 6}, {0, 1, 5}, {1, 2, 5}, {2, 4, 5}, {2, 3, 4}}) {
    mesh.triangles.push_back({a + n, b + n, c + n});
    mesh.triangles.push_back({a, c, b});
  }
  return mesh;
}

}  // namespace sansmesh::test
