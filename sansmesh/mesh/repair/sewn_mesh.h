// A mesh of a file as what it stands for: without faces that are none, its borders sewn where they lie on each other.
#pragma once

#include <cstddef>

#include "sansmesh/mesh_measures.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct SewnMesh {
  /// Only places and triangles. All vertices stand where they stood, also those that nothing uses any more.
  TriangleMesh mesh;
  std::size_t left_out =
      0;                   ///< triangles with a corner that is not finite or missing, or with two corners that are one
  std::size_t joined = 0;  ///< vertices in whose place there is another now
};

/// Edges between the same two places are one if none of them has more than one triangle, and so are their ends. Files
/// that repeat vertices (for each triangle, at seams of textures) thus hang together, and what only touches (fans of
/// triangles around a common place) stays apart. Whatever counts or measures the mesh of a file does it on this, so
/// that two commands say the same of it. Time n log n, in parallel; the same for any number of threads.
SewnMesh sewn_mesh(const TriangleMesh& mesh);

/// Topology of the sewn mesh; vertices and triangles that fell away count as unused and as degenerate as they are in
/// the file.
MeshTopology sewn_topology(const TriangleMesh& mesh);
/// The same of a mesh that is sewn already.
MeshTopology sewn_topology(const SewnMesh& sewn);

}  // namespace sansmesh::inline v1
