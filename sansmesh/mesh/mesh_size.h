// Area and enclosed volume of a mesh.
#pragma once

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Area, in the corners' unit squared.
inline double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) { return 0.5 * norm(cross(b - a, c - a)); }

struct MeshSize {
  double area = 0;  ///< length²
  /// length³, by the divergence theorem; positive if the triangles face outward. Undefined for open meshes.
  double volume = 0;
};

/// Over triangles with an area and existing corners. Independent of the number of threads.
MeshSize measure_size(const TriangleMesh& mesh);

}  // namespace sansmesh::inline v1
