// Points carried by tetrahedra, such as the vertices of a finer surface.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// Barycentric coordinates of points in the tetrahedra at rest. Points outside all tetrahedra use the nearest one and
/// extrapolate its map.
class TetEmbedding {
 public:
  /// Throws DataError for points that are not finite. The mesh is not kept.
  TetEmbedding(const TetMesh& rest, std::span<const Vec3> points);

  /// Positions of the points when the mesh's vertices are at `x`.
  std::vector<Vec3> positions(std::span<const Vec3> x) const;

  /// Unit normals of a surface through the points, transformed by the inverse transpose of the Jacobian of their
  /// tetrahedra. As many as points.
  std::vector<Vec3> normals(std::span<const Vec3> x, std::span<const Vec3> at_rest) const;

  const std::vector<std::uint32_t>& tets() const { return tets_; }
  const std::vector<std::array<double, 4>>& weights() const { return weights_; }  ///< barycentric, sum 1
  std::size_t outside() const { return outside_; }                                ///< points in no tetrahedron

 private:
  std::vector<std::uint32_t> tets_;
  std::vector<std::array<double, 4>> weights_;
  std::vector<Tet> corners_;                    ///< corners of tets_
  std::vector<std::array<Vec3, 3>> gradients_;  ///< gradients of the weights of the last three corners, at rest
  std::size_t outside_ = 0;
};

}  // namespace sansmesh::inline v1
