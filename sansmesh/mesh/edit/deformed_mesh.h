// Deforms meshes and clouds by a map of space.
#pragma once

#include <cstddef>
#include <optional>

#include "sansmesh/point_set.h"
#include "sansmesh/report.h"
#include "sansmesh/space_map.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Vertex attribute of three components for cuts. The copies of a vertex on both sides of a cut coincide; each
/// evaluates the map at this offset, on its side, and extrapolates linearly by the map's Jacobian.
inline constexpr const char* kCutSide = "cut_side";

struct MeshDeformOptions {
  /// Bisect edges whose midpoint is mapped farther than this from the midpoint of the mapped ends (length, > 0).
  /// Absent: keep all triangles.
  std::optional<double> bend;
  std::size_t most_triangles = 20000000;

  /// Throws ArgumentError that names the field.
  void validate() const;
};

struct MeshDeformReport {
  std::size_t added = 0;      ///< added triangles
  bool fine = true;           ///< false if the limit of triangles prevented bisecting all bent edges
  std::size_t undefined = 0;  ///< vertices outside the domain of the map: they do not move
  std::size_t turned = 0;     ///< vertices where the map inverts space (its determinant is not positive)
};

/// Maps vertices by `forward`, a map from positions before to positions after the deformation, and normals by the
/// inverse transpose of its Jacobian. Keeps colours and attributes, except kCutSide, which is used and removed. If the
/// mesh moves farther than its size from its origin, the origin becomes its centre.
TriangleMesh deform_mesh(TriangleMesh mesh, const SpaceMap& forward, const MeshDeformOptions& options = {},
                         MeshDeformReport* report = nullptr);

/// Same, for a cloud and its grid normals. Drops scanner positions, since the samples have moved relative to them.
PointSet deform_points(PointSet points, const SpaceMap& forward, MeshDeformReport* report = nullptr);

}  // namespace sansmesh::inline v1
