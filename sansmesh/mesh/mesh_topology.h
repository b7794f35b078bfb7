// How the triangles of a mesh hang together.
#pragma once

#include <cstddef>
#include <optional>

#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Counts over the triangles with three different corners; others are only counted as degenerate. Vertices are told
/// apart by index, not by position: a triangle soup has three boundary edges per triangle.
struct MeshTopology {
  std::size_t vertices = 0;              ///< used by a triangle
  std::size_t unused_vertices = 0;       ///< used by none
  std::size_t triangles = 0;             ///< with three different corners
  std::size_t degenerate_triangles = 0;  ///< with a repeated corner, a corner that does not exist, or without area
  std::size_t edges = 0;                 ///< different unordered pairs of vertices
  std::size_t boundary_edges = 0;        ///< of one triangle
  std::size_t boundary_loops = 0;        ///< connected sets of boundary edges: holes, where all else is manifold
  std::size_t nonmanifold_edges = 0;     ///< of three triangles or more
  std::size_t nonmanifold_vertices = 0;  ///< whose triangles form several fans
  std::size_t inconsistent_edges = 0;    ///< of two triangles that run through it in the same direction
  /// That more triangles run through in one direction than in the other: all of the boundary, and what else has faces
  /// that contradict each other.
  std::size_t open_edges = 0;
  std::size_t components = 0;         ///< sets of triangles connected by shared vertices
  std::size_t largest_component = 0;  ///< triangles of the largest one
  long euler = 0;                     ///< vertices − edges + triangles

  bool manifold() const { return nonmanifold_edges == 0 && nonmanifold_vertices == 0; }
  bool oriented() const { return inconsistent_edges == 0; }
  /// No edge is open: the volume within does not depend on where it is measured from, even if it is not manifold.
  bool encloses() const { return triangles > 0 && open_edges == 0; }
  /// No boundary, manifold, consistently oriented: the surface of a solid (self-intersections are not looked for).
  bool closed() const { return triangles > 0 && boundary_edges == 0 && manifold() && oriented(); }
  /// Number of handles of all components together; nothing unless manifold and oriented, where it has no meaning.
  std::optional<long> genus() const {
    if (triangles == 0 || !manifold() || !oriented()) return std::nullopt;
    return static_cast<long>(components) - (euler + static_cast<long>(boundary_loops)) / 2;
  }

  static const ReportSchema& schema();
};

/// Time and memory linear in the size of the mesh, in parallel.
MeshTopology measure_topology(const TriangleMesh& mesh);

}  // namespace sansmesh::inline v1
