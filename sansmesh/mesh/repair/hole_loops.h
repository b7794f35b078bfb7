// Boundary loops of a mesh whose coincident vertices are identified.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/mesh/repair/position_edges.h"
#include "sansmesh/repair_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1::detail {

/// Mesh with coincident vertices identified.
struct HoledMesh {
  const TriangleMesh& mesh;
  PositionEdges edges;
  std::vector<std::uint32_t> piece;  ///< component of each representative: its first vertex
  std::vector<Box3> box;             ///< bounding box per component

  explicit HoledMesh(const TriangleMesh& m);

  /// Whether there is an edge between two representatives.
  bool joined(std::uint32_t a, std::uint32_t b) const;
};

/// All closed loops of boundary edges, with their measures; largest first.
HoleLoops find_loops(const HoledMesh& m);

}  // namespace sansmesh::inline v1::detail
