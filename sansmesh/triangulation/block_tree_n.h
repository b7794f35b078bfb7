// The 2:1 balanced tree of cubes in N dimensions that carries the J₁ᴬ triangulation (METHODS §3.2): where its blocks
// are among each other, without coordinates in any unit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sansmesh::inline v1 {

/// A 2ᴺ-tree over a cube, N = 2, 3 or 4, as one flat array. Node 0 is the root; the 2ᴺ children of a node are
/// consecutive, bit k of a child's number being its half along axis k. Cells are integer: block `cell` of level l is
/// the cube [cell, cell + 1]·2⁻ˡ, the root being [0, 1]ᴺ.
template <int N>
class BlockTreeN {
 public:
  static constexpr int kMaxLevel = 16;                    ///< lattice coordinates stay within 20 bits
  static constexpr std::size_t kMostBlocks = 0x7fffffff;  ///< children are found by 31 bits
  static constexpr std::uint32_t kChildren = 1u << N;

  struct Block {
    std::int32_t first_child = -1;  ///< -1: a leaf
    std::uint8_t level = 0;
    std::array<std::uint32_t, N> cell{};
  };
  /// Like Block::cell, but may lie outside the root.
  using Cell = std::array<std::int64_t, N>;

  /// A tree that is one block.
  BlockTreeN() : blocks_(1) {}

  std::size_t size() const { return blocks_.size(); }
  const Block& operator[](std::size_t i) const { return blocks_[i]; }
  bool is_leaf(std::size_t i) const { return blocks_[i].first_child < 0; }
  int depth() const { return depth_; }  ///< deepest level present

  /// Cuts a leaf in 2ᴺ; returns the index of its first child. Throws ArgumentError beyond kMaxLevel,
  /// DataError beyond kMostBlocks.
  std::size_t subdivide(std::size_t i);

  /// The deepest block of at most `level` that contains this cell of that level; -1 outside the root.
  std::int64_t find(int level, const Cell& cell) const;

  /// True if the block at exactly this level and cell exists and is subdivided.
  bool subdivided(int level, const Cell& cell) const;

  /// Subdivides until blocks that share as much as a corner differ by one level at most.
  void balance();

  /// Leaves in tree order (a space-filling order).
  std::vector<std::uint32_t> leaves() const;

 private:
  int depth_ = 0;
  std::vector<Block> blocks_;
};

extern template class BlockTreeN<2>;
extern template class BlockTreeN<3>;
extern template class BlockTreeN<4>;

}  // namespace sansmesh::inline v1
