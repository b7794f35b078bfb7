// Tetrahedral mesh with shared vertices: result of readers and input of simulations.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/attribute_table.h"
#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Corners of a tetrahedron: vertex indices.
using Tet = std::array<std::uint32_t, 4>;

/// Vertices and tetrahedra. The corners (a, b, c, d) of a tetrahedron are ordered such that (b − a) · ((c − a) × (d −
/// a)), six times its volume, is positive. Files contain both orders; readers keep the order of the file.
struct TetMesh {
  std::vector<Vec3> vertices;     ///< world positions
  std::vector<Tet> tets;          ///< indices into `vertices`
  AttributeTable attributes;      ///< a row per vertex
  AttributeTable tet_attributes;  ///< a row per tetrahedron
};

/// Bounding box of the vertices, unused ones included.
inline Box3 bounds(const TetMesh& mesh) {
  Box3 box;
  for (const Vec3& p : mesh.vertices) box.extend(p);
  return box;
}

}  // namespace sansmesh::inline v1
