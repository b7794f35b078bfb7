// Cuts along triangle meshes.
#pragma once

#include <memory>
#include <optional>

#include "sansmesh/box.h"
#include "sansmesh/deform/cuts/occluder.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct MeshOccluderOptions {
  /// Cells along the longest side of the lattice on which detours are computed; 8..256. Each handle takes 4 bytes per
  /// node and, on first use, about a second per million nodes.
  int resolution = 64;
  /// Region that the lattice covers in addition to the mesh: usually the handles and everything that is deformed.
  /// Outside it, detours are those of the nearest point inside. Default: the box of the mesh, enlarged by half of its
  /// diagonal on all sides.
  std::optional<Box3> domain = {};

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// An open surface, flat or curved, of any number of components; detours lead around its border. Points beyond a
/// surface without a border are unreachable: detours there are finite, a million times the size of the lattice.
///
/// - Detours are computed on a lattice (DetourLattice), for each handle on first use, and cached. Their error is a
/// fraction
///   of a cell; detail of the surface finer than a cell is missed. Points within a cell of the shadow's edge may have a
///   detour, of the order of the squared cell size over the distance from the border.
/// - Gaps: with a and b the distances of x and of its source from the surface, the depth is the smaller of ab/(a + b)
///   and the distance from the border at which the segment between them crosses the surface; with two crossings, half
///   the distance between them. Without a crossing, the depth is the segment's distance from the surface, negated:
///   continuous where it passes the border or touches a fold.
///
/// Throws ArgumentError for bad options and for a mesh without a triangle that has an area.
std::shared_ptr<const Occluder> mesh_occluder(const TriangleMesh& mesh, const MeshOccluderOptions& options = {});

}  // namespace sansmesh::inline v1
