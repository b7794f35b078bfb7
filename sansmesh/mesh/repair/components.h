// Connected components of a mesh, and meshes with some of their triangles taken away.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct MeshComponents {
  std::vector<std::uint32_t>
      of_triangle;           ///< component of each triangle; 0 is the one with the largest area, and so on
  std::vector<double> area;  ///< length²
  std::size_t size() const { return area.size(); }
};

/// Triangles that share a vertex are connected.
MeshComponents find_components(const TriangleMesh& mesh);

/// Keeps the triangles whose entry in `keep` is not 0, and the vertices they use, in order, with all that belongs to
/// them.
void keep_triangles(TriangleMesh& mesh, const std::vector<std::uint8_t>& keep);

/// Each component as a mesh of its own, in their order, with all that belongs to it; vertices that no triangle uses are
/// in none. All together takes as long as to copy the mesh.
std::vector<TriangleMesh> split_components(const TriangleMesh& mesh, const MeshComponents& components);

/// Cuts vertices at which several fans of triangles meet into one vertex per fan (removing triangles can leave such
/// vertices).
void separate_fans(TriangleMesh& mesh);

}  // namespace sansmesh::inline v1
