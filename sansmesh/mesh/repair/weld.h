// Merges vertices that are close together.
#pragma once

#include <cstddef>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct WeldReport {
  std::size_t vertices = 0;   ///< removed vertices
  std::size_t triangles = 0;  ///< removed triangles: two of their corners were merged
  /// Increase of the number of edges with three or more triangles.
  std::size_t nonmanifold_edges = 0;
};

/// Merges vertices within `distance` (length, >= 0) of an earlier one into it (see close_representatives; 0: coincident
/// ones). Its position stays; normals, colours and attributes become means (normals without a direction become zero;
/// integers take the first). Throws ArgumentError for an invalid distance.
WeldReport weld_vertices(TriangleMesh& mesh, double distance);

}  // namespace sansmesh::inline v1
