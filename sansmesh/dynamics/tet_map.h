// Piecewise affine map of space given by tetrahedra.
#pragma once

#include <memory>
#include <span>

#include "sansmesh/space_map.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// Maps points in the tetrahedra with vertices at `from` to the same barycentric coordinates with vertices at `to`. For
/// fields and volumes (backward map), `from` are the moved vertices and `to` those at rest.
class TetMap final : public SpaceMap {
 public:
  /// Throws ArgumentError if sizes differ from the mesh's number of vertices, DataError if no tetrahedron at `from` has
  /// a volume. Flat tetrahedra are left out.
  TetMap(std::span<const Tet> tets, std::span<const Vec3> from, std::span<const Vec3> to);
  ~TetMap() override;

  /// NaN outside all tetrahedra, Jacobians too. Where tetrahedra overlap, the first one counts. The determinant of the
  /// Jacobian is negative in inverted tetrahedra.
  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override;

  /// Images of the boxes' contents; empty where there is no tetrahedron.
  void images(std::span<const Box3> boxes, std::span<Box3> found) const override;

  /// The tetrahedron that contains each point; kNowhere outside all.
  void find(std::span<const Vec3> x, std::span<std::uint32_t> tets) const;
  static constexpr std::uint32_t kNowhere = 0xffffffffu;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace sansmesh::inline v1
