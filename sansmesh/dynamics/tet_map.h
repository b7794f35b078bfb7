// The map of space that tetrahedra carry: within each of them it is affine.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sansmesh/space_map.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// Positions in the tetrahedra with their vertices at `from` to the same places in them with their vertices at `to`.
/// As a map for fields and volumes (backward) `from` are the moved vertices and `to` those at rest.
class TetMap final : public SpaceMap {
 public:
  /// Throws ArgumentError where sizes differ from the mesh's number of vertices, DataError where no tetrahedron at
  /// `from` has a volume. Flat ones are left out.
  TetMap(std::span<const Tet> tets, std::span<const Vec3> from, std::span<const Vec3> to);
  ~TetMap() override;

  /// NaN outside of all tetrahedra, Jacobians too. Where tetrahedra overlap, the first one counts. The determinant of
  /// the Jacobian is negative in tetrahedra that are inside out.
  void map(std::span<const Vec3> x, const MapAnswers& wanted) const override;

  /// Of what lies in each box; empty where there is no tetrahedron.
  void images(std::span<const Box3> boxes, std::span<Box3> found) const override;

  /// The tetrahedron that each point lies in, kNowhere outside of all.
  void find(std::span<const Vec3> x, std::span<std::uint32_t> tets) const;
  static constexpr std::uint32_t kNowhere = 0xffffffffu;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace sansmesh::inline v1
