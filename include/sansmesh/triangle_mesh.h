// Indexed triangle mesh: result of polygonisation and input of every writer.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/attribute_table.h"
#include "sansmesh/box.h"
#include "sansmesh/point_set.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Corners of a triangle: vertex indices.
using Triangle = std::array<std::uint32_t, 3>;

/// Vertices and triangles. Triangles are counter-clockwise seen from outside. Optional arrays are empty or as long as
/// `vertices`.
struct TriangleMesh {
  Vec3 origin;                                      ///< world position = origin + vertex
  std::vector<Vec3f> vertices;                      ///< positions relative to `origin`
  std::vector<Triangle> triangles;                  ///< indices into `vertices`
  std::vector<Vec3f> normals;                       ///< outward unit normals
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< RGB, 0..255
  AttributeTable attributes;           ///< other properties of the vertices (quality, curvatures, …): a row each
  AttributeTable triangle_attributes;  ///< properties of the triangles: a row each
  std::shared_ptr<const ReferenceSystem> reference = {};  ///< reference system of the coordinates; null if unknown
};

/// Bounding box of the vertices (relative to the origin), unused ones included.
inline Box3f bounds(const TriangleMesh& mesh) {
  Box3f box;
  for (const Vec3f& p : mesh.vertices) box.extend(p);
  return box;
}

/// Positions and triangles of a cloud, with normals, colours and attributes. Drops data without a counterpart in a mesh
/// (scans, scanners, grid normals).
SANSMESH_API TriangleMesh to_mesh(PointSet points);

}  // namespace sansmesh::inline v1
