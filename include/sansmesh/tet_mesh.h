// Tetrahedra with shared vertices: what readers of tetrahedral meshes return and what moves by forces.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/attribute_table.h"
#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Corners of a tetrahedron: indices into the vertices.
using Tet = std::array<std::uint32_t, 4>;

/// Vertices, and the tetrahedra between them. Corners of a tetrahedron (a, b, c, d) are in such an order that (b − a) ·
/// ((c − a) × (d − a)), six times its volume, is positive. Files have them in either order: readers keep that.
struct TetMesh {
  std::vector<Vec3> vertices;     ///< positions in the world
  std::vector<Tet> tets;          ///< indices into `vertices`
  AttributeTable attributes;      ///< a row for each vertex
  AttributeTable tet_attributes;  ///< a row for each tetrahedron
};

/// Smallest box around the vertices, those that no tetrahedron uses included.
inline Box3 bounds(const TetMesh& mesh) {
  Box3 box;
  for (const Vec3& p : mesh.vertices) box.extend(p);
  return box;
}

}  // namespace sansmesh::inline v1
