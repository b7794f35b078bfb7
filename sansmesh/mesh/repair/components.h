// Connected components of a mesh, and removal of triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct MeshComponents {
  std::vector<std::uint32_t> of_triangle;  ///< component of each triangle, in descending order of area
  std::vector<double> area;                ///< length²
  std::size_t size() const { return area.size(); }
};

/// Triangles with a common vertex are connected.
MeshComponents find_components(const TriangleMesh& mesh);

/// Keeps the triangles whose entry in `keep` is not 0, and their vertices, in order, with all attributes.
void keep_triangles(TriangleMesh& mesh, const std::vector<std::uint8_t>& keep);

/// Splits the mesh into its components, in order, with all attributes; drops vertices without triangles. Takes about
/// the time of copying the mesh.
std::vector<TriangleMesh> split_components(const TriangleMesh& mesh, const MeshComponents& components);

/// Splits vertices at which several fans of triangles meet into one vertex per fan (removing triangles can create such
/// vertices).
void separate_fans(TriangleMesh& mesh);

}  // namespace sansmesh::inline v1
