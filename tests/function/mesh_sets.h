// Meshes as sets of triangles, their sizes, and boxes around parts of them; for the tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "sansmesh/core/boxes.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::test {

using Corners = std::array<std::array<float, 3>, 3>;

/// A triangle by the positions of its corners, independent of indices and rotation.
inline Corners corners(const TriangleMesh& mesh, const Triangle& t) {
  Corners c;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f& v = mesh.vertices[t[k]];
    c[k] = {v.x, v.y, v.z};
  }
  std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
  return c;
}
inline std::set<Corners> triangle_set(const TriangleMesh& mesh) {
  std::set<Corners> set;
  for (const Triangle& t : mesh.triangles) set.insert(corners(mesh, t));
  return set;
}

inline bool near_box(const TriangleMesh& mesh, const Triangle& t, const Box3& box) {
  Box3 b;
  for (const std::uint32_t v : t) b.extend(mesh.origin + Vec3(mesh.vertices[v]));
  for (std::size_t k = 0; k < 3; ++k)
    if (b.upper[k] < box.lower[k] || b.lower[k] > box.upper[k]) return false;
  return true;
}

inline double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) sum += norm(Vec3(mesh.vertices[t[0]] - mesh.vertices[t[1]]));
  return sum / static_cast<double>(mesh.triangles.size());
}

inline void expect_closed(const TriangleMesh& mesh) {
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.degenerate_triangles, 0u);
  EXPECT_EQ(topology.unused_vertices, 0u);
}

inline double area_of(const TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles)
    area += 0.5 * norm(cross(Vec3(mesh.vertices[t[1]] - mesh.vertices[t[0]]),
                             Vec3(mesh.vertices[t[2]] - mesh.vertices[t[0]])));
  return area;
}

}  // namespace sansmesh::test
