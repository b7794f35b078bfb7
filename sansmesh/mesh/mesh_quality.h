// How well-shaped the triangles of a mesh are, and how much they enclose.
#pragma once

#include <cstddef>

#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Over the triangles with an area; lengths in the unit of the mesh, angles in degrees.
struct MeshQuality {
  std::size_t triangles = 0;  ///< that have an area
  /// Aspect ratio AR = l_max P / (4 √3 S) with longest edge l_max, perimeter P, area S: 1 for an equilateral triangle
  /// (METHODS 3.3; tejada2008, section 3.3). Ratios above 1e6 count as 1e6, so that one sliver does not hide the rest.
  double aspect_mean = 0, aspect_deviation = 0, aspect_max = 0;
  double smallest_angle_mean = 0;  ///< mean over the triangles of their smallest angle: 60 at best
  double smallest_angle = 0;       ///< of all
  double small_angle_share = 0;    ///< share in 0..1 of triangles with an angle below 10°
  double edge_mean = 0;            ///< mean over the triangles' edges (inner ones count twice)
  double area = 0;                 ///< length²
  /// length³, by the divergence theorem; positive if the triangles face outward. Meaningless for open meshes.
  double volume = 0;

  static const ReportSchema& schema();
};

/// Deterministic for any number of threads.
MeshQuality measure_quality(const TriangleMesh& mesh);

/// l_max P / (4 √3 S); infinite without an area.
double aspect_ratio(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace sansmesh::inline v1
