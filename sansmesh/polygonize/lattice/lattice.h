// Numbered vertices of the J₁ᴬ triangulation of a block tree, and tables of the simplices of a block.
//
// triangulation/j1a.h has the algebra of single simplices. Here a table divides a whole block at once, which suits an
// extraction that visits every crossing block. tests/triangulation/j1a_lattice_test.cpp compares the two.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

/// Integer coordinates of a lattice vertex: multiples of half the edge of a block on the tree's deepest level.
using LatticePoint = std::array<std::uint32_t, 3>;

/// Numbers lattice points in order of first use. Points of one scale are stored in dense 4³ bricks, so that look-ups of
/// neighbours hit the same cache lines; a hash table with linear probing finds the bricks.
class LatticeNumbering {
 public:
  std::uint32_t number(const LatticePoint& p);
  const std::vector<LatticePoint>& points() const { return points_; }

 private:
  struct Entry {
    std::uint64_t key = ~std::uint64_t{0};
    std::uint32_t brick = 0;
  };
  std::uint32_t brick_of(std::uint64_t key);
  void grow();

  std::vector<Entry> table_;  ///< size is a power of two
  std::deque<std::array<std::uint32_t, 64>> bricks_;
  std::vector<LatticePoint> points_;
  std::uint64_t last_key_ = ~std::uint64_t{0};
  std::uint32_t last_brick_ = 0;
};

/// Subdivision of a block: its lattice vertices as positions on the 5×5×5 grid of quarter edges (slot = x + 5y + 25z;
/// 62 is the centre) and its simplices as indices into `slots`, positively oriented.
struct BlockPattern {
  std::vector<std::uint8_t> slots;
  std::vector<std::array<std::uint8_t, 4>> tets;
  /// Indices into `slots` of the vertices on each face (2·axis + side).
  std::array<std::vector<std::uint8_t>, 6> face;
};

/// Faces (bit 2·axis + side) and edges (bit 4·axis + lower-other-axis side + 2·higher-other-axis side) at which a leaf
/// meets finer blocks. The tree must be balanced.
struct BlockRefinement {
  std::uint32_t faces = 0;
  std::uint32_t edges = 0;
};
BlockRefinement refinement_of(const BlockTree& tree, std::uint32_t block);

/// Lattice vertex at a slot of a block. Quarter edges exist only where the block is not on the deepest level, so the
/// division is exact.
inline LatticePoint slot_point(const BlockTree& tree, std::uint32_t block, std::uint32_t slot) {
  const BlockTree::Block& b = tree[block];
  const std::uint32_t edge = 2u << (tree.depth() - b.level);
  return {b.cell[0] * edge + slot % 5u * edge / 4, b.cell[1] * edge + slot / 5u % 5u * edge / 4,
          b.cell[2] * edge + slot / 25u * edge / 4};
}

/// Position of a lattice vertex.
inline Vec3 lattice_position(const BlockTree& tree, const LatticePoint& p) {
  const double unit = tree.edge() / static_cast<double>(2u << tree.depth());
  return tree.lower() + Vec3{p[0] * unit, p[1] * unit, p[2] * unit};
}

/// Cache of patterns; references stay valid.
class PatternTable {
 public:
  const BlockPattern& pattern(const BlockRefinement& refinement);

 private:
  std::vector<std::unique_ptr<BlockPattern>> patterns_;  ///< indexed by faces and edges: 18 bits
};

}  // namespace sansmesh::inline v1
