// Signed distance to a mesh.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/cell_list.h"
#include "sansmesh/measure/signed_distance.h"
#include "sansmesh/mesh/mesh_closest.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Exact distance to the triangles. The sign is that of the pseudo-normal at the closest point: of a face, an edge (sum
/// of the unit normals of its faces) or a vertex (sum weighted by angles), which is correct for every closed mesh
/// (Bærentzen and Aanæs 2005). Coincident vertices are joined. At the border of an open mesh the adjacent faces
/// determine the side. Triangles without area take the normals of their neighbours.
class MeshDistance : public SignedDistance {
 public:
  /// Keeps a reference to the mesh. Throws DataError if there is no triangle with finite corners.
  explicit MeshDistance(const TriangleMesh& mesh);

  Box3 bounds() const override { return bounds_; }
  void measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const override;

  /// Pseudo-normal of a `part` of a triangle; zero where normals cancel. `border` becomes true if a face ends there.
  Vec3 pseudo_normal(std::uint32_t triangle, TrianglePart part, bool& border) const;

 private:
  Vec3 position(std::uint32_t corner) const { return Vec3(mesh_.vertices[corner]); }
  Triangle corners(std::uint32_t triangle) const;
  Vec3 face_normal(std::uint32_t triangle) const;
  Vec3 normals_across(std::uint32_t triangle, std::uint32_t a, std::uint32_t b) const;
  Vec3 edge_normal(std::uint32_t a, std::uint32_t b, bool& border) const;
  Vec3 vertex_normal(std::uint32_t corner, bool& border) const;

  const TriangleMesh& mesh_;
  ClosestTriangle closest_;
  Box3 bounds_;
  std::vector<std::uint32_t> same_;  ///< per vertex: the first coincident one
  Adjacency triangles_at_;           ///< per vertex: its triangles
};

/// The distance to a mesh, or to points if it has no triangles. Keeps a reference.
std::unique_ptr<SignedDistance> signed_distance(const TriangleMesh& surface);

}  // namespace sansmesh::inline v1
