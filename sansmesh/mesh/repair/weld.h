// Vertices that lie close together become one.
#pragma once

#include <cstddef>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct WeldReport {
  std::size_t vertices = 0;   ///< that are gone
  std::size_t triangles = 0;  ///< that are gone, since two of their corners became one
  /// Edges of three triangles or more that were not there before, as far as more are there than before.
  std::size_t nonmanifold_edges = 0;
};

/// Vertices no farther than `distance` (length, >= 0) from one before them become that one (as close_representatives
/// says; 0: those at the same place). It stays where it is; normals, colours and attributes become means (of normals
/// without a direction left: none; of integers: the first). Throws ArgumentError for another distance.
WeldReport weld_vertices(TriangleMesh& mesh, double distance);

}  // namespace sansmesh::inline v1
