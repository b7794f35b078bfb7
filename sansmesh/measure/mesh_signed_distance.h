// How far a point lies from a mesh, and on which side.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sansmesh/measure/signed_distance.h"
#include "sansmesh/mesh/mesh_closest.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Exact distance to the triangles, the sign from the pseudo-normal of what the closest point lies on: the face, the
/// edge (sum of its faces' unit normals) or the vertex (sum weighted by their angles there), which is right for every
/// closed mesh (Bærentzen and Aanæs 2005). Vertices at the same place are one. At the border of an open mesh it is the
/// side of the faces that end there. Triangles without area have no normal: that of their neighbours stands in.
class MeshDistance : public SignedDistance {
 public:
  /// Keeps a reference to the mesh. Throws DataError if there is no triangle with finite corners.
  explicit MeshDistance(const TriangleMesh& mesh);

  Box3 bounds() const override { return bounds_; }
  void measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const override;

  /// Of what `part` of a triangle stands for; zero where it cancels out. `border` becomes true if a face ends there.
  Vec3 pseudo_normal(std::uint32_t triangle, TrianglePart part, bool& border) const;

 private:
  std::span<const std::uint32_t> triangles_at(std::uint32_t corner) const;
  Vec3 position(std::uint32_t corner) const { return Vec3(mesh_.vertices[corner]); }
  Triangle corners(std::uint32_t triangle) const;
  Vec3 face_normal(std::uint32_t triangle) const;
  Vec3 normals_across(std::uint32_t triangle, std::uint32_t a, std::uint32_t b) const;
  Vec3 edge_normal(std::uint32_t a, std::uint32_t b, bool& border) const;
  Vec3 vertex_normal(std::uint32_t corner, bool& border) const;

  const TriangleMesh& mesh_;
  ClosestTriangle closest_;
  Box3 bounds_;
  std::vector<std::uint32_t> same_;   ///< of each vertex: the first one at its place
  std::vector<std::uint32_t> first_;  ///< of each vertex: where its triangles begin in triangles_
  std::vector<std::uint32_t> triangles_;
};

/// The distance to a mesh, or to points if it has no triangles. Keeps a reference to it.
std::unique_ptr<SignedDistance> signed_distance(const TriangleMesh& surface);

}  // namespace sansmesh::inline v1
