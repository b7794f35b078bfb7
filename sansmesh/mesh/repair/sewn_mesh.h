// Mesh of a file without invalid faces and with coincident borders joined.
#pragma once

#include <cstddef>

#include "sansmesh/mesh_measures.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct SewnMesh {
  /// Only positions and triangles. Vertices keep their positions, including those that are no longer used.
  TriangleMesh mesh;
  std::size_t left_out = 0;  ///< triangles with an invalid corner or two equal corners
  std::size_t joined = 0;    ///< vertices replaced by another one at their position
};

/// Joins edges between the same two positions, and their ends, if each of them has one triangle. This connects files
/// that repeat vertices (for each triangle, or at texture seams) but keeps parts separate that merely touch (fans of
/// triangles around a common position). All counts and measures of the mesh of a file use it, so that commands agree.
/// Time n log n, in parallel; independent of the number of threads.
SewnMesh sewn_mesh(const TriangleMesh& mesh);

/// Topology of the sewn mesh; removed vertices and triangles count as unused and degenerate as in the file.
MeshTopology sewn_topology(const TriangleMesh& mesh);
/// Same, for a mesh that is already sewn.
MeshTopology sewn_topology(const SewnMesh& sewn);

}  // namespace sansmesh::inline v1
