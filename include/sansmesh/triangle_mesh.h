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

using Triangle = std::array<std::uint32_t, 3>;

/// Triangles are counter-clockwise seen from outside. Optional arrays are empty or as long as `vertices`.
struct TriangleMesh {
  Vec3 origin;                  ///< World position = origin + vertex.
  std::vector<Vec3f> vertices;  ///< Relative to `origin`.
  std::vector<Triangle> triangles;
  std::vector<Vec3f> normals;                       ///< Unit, outward.
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< RGB, 0..255.
  /// Whatever else is known of each vertex (quality, distance, curvatures, …) and of each triangle: a row each.
  AttributeTable attributes, triangle_attributes;
};

inline Box3f bounds(const TriangleMesh& mesh) {
  Box3f box;
  for (const Vec3f& p : mesh.vertices) box.extend(p);
  return box;
}

/// Positions and triangles of a cloud, with normals, colours and attributes.
SANSMESH_API TriangleMesh to_mesh(PointSet points);

}  // namespace sansmesh::inline v1
