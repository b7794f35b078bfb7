// The vertices of the J₁ᴬ triangulation of a block tree, numbered, and the simplices of a block in terms of them.
//
// triangulation/j1a.h has the algebra of single simplices; here a whole block is cut at once from a table, which is
// what an extraction that visits every crossing block needs. tests/triangulation/j1a_lattice_test.cpp holds the two
// against each other.
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

/// Numbers lattice points in the order they are first asked for. Points of one scale live in dense 4³ bricks, so that
/// look-ups of neighbours hit the same cache lines; the bricks are found by a hash table with linear probing.
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

  std::vector<Entry> table_;  ///< a power of two
  std::deque<std::array<std::uint32_t, 64>> bricks_;
  std::vector<LatticePoint> points_;
  std::uint64_t last_key_ = ~std::uint64_t{0};
  std::uint32_t last_brick_ = 0;
};

/// How a block is cut: its lattice vertices as positions on the 5×5×5 grid of quarter edges (slot = x + 5y + 25z; the
/// centre is 62) and its simplices as positions in `slots`, positively oriented.
struct BlockPattern {
  std::vector<std::uint8_t> slots;
  std::vector<std::array<std::uint8_t, 4>> tets;
  /// Positions in `slots` of the vertices on each face (2·axis + side).
  std::array<std::vector<std::uint8_t>, 6> face;
};

/// Which faces (bit 2·axis + side) and edges (bit 4·axis + lower-other-axis side + 2·higher-other-axis side) of a leaf
/// meet finer blocks. The tree must be balanced.
struct BlockRefinement {
  std::uint32_t faces = 0;
  std::uint32_t edges = 0;
};
BlockRefinement refinement_of(const BlockTree& tree, std::uint32_t block);

/// The patterns met so far; references stay valid.
class PatternTable {
 public:
  const BlockPattern& pattern(const BlockRefinement& refinement);

 private:
  std::vector<std::unique_ptr<BlockPattern>> patterns_;  ///< by faces and edges: 18 bits
};

}  // namespace sansmesh::inline v1
