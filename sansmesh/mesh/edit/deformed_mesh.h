// Meshes and clouds moved by a map of space.
#pragma once

#include <cstddef>
#include <optional>

#include "sansmesh/point_set.h"
#include "sansmesh/report.h"
#include "sansmesh/space_map.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Attribute of vertices, three numbers: where a cut passes, the copies of a vertex on its two sides lie in the same
/// place, and each is to be looked at from this far beside it, where the map is that of its side. It goes from there in
/// a straight line by the map's Jacobian.
inline constexpr const char* kCutSide = "cut_side";

struct MeshDeformOptions {
  /// Edges are cut in half beforehand whose middle comes to lie farther than this from the middle of where their ends
  /// come (length, > 0). None: triangles stay as they are, however large.
  std::optional<double> bend;
  std::size_t most_triangles = 20000000;

  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct MeshDeformReport {
  std::size_t added = 0;      ///< triangles
  bool fine = true;           ///< false: there were too many triangles to cut all edges that bend
  std::size_t undefined = 0;  ///< vertices where the map is not defined: they stay where they are
  std::size_t turned = 0;     ///< vertices at which the map turns space inside out (its determinant is not positive)
};

/// Vertices by `forward`, a map from places before to places after the deformation; normals by the inverse transpose of
/// its Jacobian; colours and attributes are carried as they are but for kCutSide, which is heeded and left out. The
/// origin stays near: where the mesh moves away from it farther than its size, it becomes its middle.
TriangleMesh deform_mesh(TriangleMesh mesh, const SpaceMap& forward, const MeshDeformOptions& options = {},
                         MeshDeformReport* report = nullptr);

/// The same of a cloud, and of the normals of its grids. Positions of scanners are left out: samples moved away from
/// where they were seen.
PointSet deform_points(PointSet points, const SpaceMap& forward, MeshDeformReport* report = nullptr);

}  // namespace sansmesh::inline v1
