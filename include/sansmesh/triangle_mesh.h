// Indexed triangle mesh: what polygonisation returns and every writer takes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/attribute_table.h"
#include "sansmesh/box.h"
#include "sansmesh/point_set.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Corners of a triangle: indices into the vertices.
using Triangle = std::array<std::uint32_t, 3>;

/// Vertices, and the triangles between them. Triangles are counter-clockwise seen from outside. Optional arrays are
/// empty or as long as `vertices`.
struct TriangleMesh {
  Vec3 origin;                                      ///< World position = origin + vertex.
  std::vector<Vec3f> vertices;                      ///< Relative to `origin`.
  std::vector<Triangle> triangles;                  ///< Indices into `vertices`.
  std::vector<Vec3f> normals;                       ///< Unit, outward.
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< RGB, 0..255.
  AttributeTable attributes;  ///< Whatever else is known of each vertex (quality, curvatures, …): a row each.
  AttributeTable triangle_attributes;  ///< What is known of each triangle: a row each.
};

/// Smallest box around the vertices (relative to the origin), those that no triangle uses included.
inline Box3f bounds(const TriangleMesh& mesh) {
  Box3f box;
  for (const Vec3f& p : mesh.vertices) box.extend(p);
  return box;
}

/// Positions and triangles of a cloud, with normals, colours and attributes. What a mesh has no room for (scans,
/// scanners, normals of grids) is left out.
SANSMESH_API TriangleMesh to_mesh(PointSet points);

}  // namespace sansmesh::inline v1
