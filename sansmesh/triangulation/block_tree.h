// 2:1 balanced octree of cubic blocks in space, which carries the J₁ᴬ triangulation (castelo2006).
#pragma once

#include <cstdint>

#include "sansmesh/box.h"
#include "sansmesh/triangulation/block_tree_n.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Range of accepted depths, for trees of fits and for blocks of meshes.
constexpr int kLeastDepth = 2, kMostDepth = 14;

/// Octree over a cube: block (i, j, k) of level l is the cube lower + edge·2⁻ˡ·[(i,j,k), (i+1,j+1,k+1)]; its children
/// are in the order x + 2y + 4z.
class BlockTree : public BlockTreeN<3> {
 public:
  /// A tree of one block: the cube with this corner and edge length.
  BlockTree(const Vec3& lower, double edge) : lower_(lower), edge_(edge) {}

  const Vec3& lower() const { return lower_; }
  double edge() const { return edge_; }
  Box3 bounds() const { return {lower_, lower_ + Vec3{edge_, edge_, edge_}}; }

  double block_edge(std::size_t i) const { return edge_ / static_cast<double>(1u << (*this)[i].level); }
  Vec3 block_center(std::size_t i) const {
    const Block& b = (*this)[i];
    const double h = block_edge(i);
    return lower_ + Vec3{(b.cell[0] + 0.5) * h, (b.cell[1] + 0.5) * h, (b.cell[2] + 0.5) * h};
  }

  using BlockTreeN<3>::find;
  std::int64_t find(int level, std::int64_t i, std::int64_t j, std::int64_t k) const {
    return BlockTreeN<3>::find(level, {i, j, k});
  }
  using BlockTreeN<3>::subdivided;
  bool subdivided(int level, std::int64_t i, std::int64_t j, std::int64_t k) const {
    return BlockTreeN<3>::subdivided(level, {i, j, k});
  }

 private:
  Vec3 lower_;
  double edge_;
};

}  // namespace sansmesh::inline v1
