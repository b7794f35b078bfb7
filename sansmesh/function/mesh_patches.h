// Decomposition of a mesh into smooth patches, the crease curves between them, and the corners of these.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Edge statistics of a mesh whose coincident vertices are merged.
struct MeshEdges {
  std::size_t edges = 0;
  std::size_t open = 0;     ///< edges of one face
  std::size_t tangled = 0;  ///< edges of at least three faces, or of two with the same direction of the edge
};

struct MeshPatches {
  static constexpr std::uint32_t kSmooth = std::numeric_limits<std::uint32_t>::max();

  /// Corners of each triangle: the first of their coincident vertices.
  std::vector<Triangle> triangles;
  /// Unit normals of the triangles; zero if they have no area.
  std::vector<Vec3> normal;
  /// Patch of each triangle: connected over edges that are no creases.
  std::vector<std::uint32_t> patch;
  /// Curve of each edge (3 · triangle + k, from corner k to the next one); kSmooth: inside of a patch.
  std::vector<std::uint32_t> curve;
  /// The triangle behind each edge; kSmooth unless there is exactly one.
  std::vector<std::uint32_t> across;
  /// For each vertex the curve through it, or, from `curves` on, its corner; kSmooth: inside of a patch.
  std::vector<std::uint32_t> feature;
  std::uint32_t patches = 0, curves = 0, corners = 0;
  MeshEdges edges;
  /// Edges of one face, as 3 · triangle + k.
  std::vector<std::uint32_t> open;

  /// Creases are edges whose faces' normals differ by more than this angle (degrees), and those without exactly two
  /// faces. Curves shorter than `least_crease` (length) are ignored if they end inside of a patch, or close.
  MeshPatches(const TriangleMesh& mesh, double crease_angle, double least_crease = 0);
};

}  // namespace sansmesh::inline v1
