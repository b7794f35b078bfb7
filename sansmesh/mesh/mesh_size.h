// Area of a mesh, and the volume that it encloses.
#pragma once

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// In the unit of the corners, squared.
inline double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) { return 0.5 * norm(cross(b - a, c - a)); }

struct MeshSize {
  double area = 0;  ///< length²
  /// length³, by the divergence theorem; positive if the triangles face outward. Meaningless for open meshes.
  double volume = 0;
};

/// Over the triangles that have an area and corners that exist. Deterministic for any number of threads.
MeshSize measure_size(const TriangleMesh& mesh);

}  // namespace sansmesh::inline v1
