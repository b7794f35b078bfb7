// Cuts along surfaces of triangles.
#pragma once

#include <memory>
#include <optional>

#include "sansmesh/box.h"
#include "sansmesh/deform/occluder.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct MeshOccluderOptions {
  /// Cells of the lattice, on which ways around are found, along its longest side; 8..256. Each handle takes 4 bytes a
  /// node and, when it is first asked for, about a second for a million nodes.
  int resolution = 64;
  /// What the lattice covers, besides the mesh itself: as a rule handles and all that is deformed. Beyond it detours
  /// are those of the nearest place within. Default: the box of the mesh, grown by half of its diagonal to all sides.
  std::optional<Box3> domain = {};

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// An open surface, flat or not, of any number of pieces; its border is what ways go around. What lies beyond a surface
/// without a border cannot be reached: detours there are finite, a million times the size of the lattice.
///
/// - Detours are found on a lattice (FreeWays), for each handle when it is first asked for, and kept. They miss the
///   true ones by a fraction of a cell, and detail of the surface finer than a cell. Places within a cell of the
///   shadow's edge may have a detour, too: of the square of a cell's length over the distance from the border.
/// - Gaps: with a and b the distances of x and of its source from the surface, the depth is the smaller of ab/(a + b)
///   and of how far from the border the segment between them crosses it; where that crosses twice, of half the
///   distance between the crossings. Where the segment does not cross, the depth is its distance from the surface,
///   negated: continuous where it passes the border or touches a fold.
///
/// Throws ArgumentError for bad options and for a mesh without a triangle that has an area.
std::shared_ptr<const Occluder> mesh_occluder(const TriangleMesh& mesh, const MeshOccluderOptions& options = {});

}  // namespace sansmesh::inline v1
