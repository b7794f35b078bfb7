// Closes handles and tunnels of a mesh that its samples do not support.
#pragma once

#include <cstddef>

#include "sansmesh/point_set.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

struct NarrowHandles {
  std::size_t genus = 0;   ///< handles that remain
  std::size_t closed = 0;  ///< handles that were cut
  std::size_t narrow = 0;  ///< remaining ones whose loop is short, or has no samples around it
  Vec3 narrowest;          ///< centre of the shortest remaining one, in the coordinates of the mesh
};

/// Finds the handles with a short loop (docs/methods/polygonisation.md), and with `close` cuts those that samples do
/// not support. Lengths in the unit of the mesh. Without normals of the samples every handle stays; without samples,
/// short means short against `spacing`. Independent of the number of threads.
NarrowHandles close_handles(TriangleMesh& mesh, const PointSet& points, double spacing, double noise, bool close);

}  // namespace sansmesh::inline v1::detail
