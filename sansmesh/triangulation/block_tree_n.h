// 2:1 balanced tree of cubes in N dimensions, which carries the J₁ᴬ triangulation (castelo2006): adjacency of blocks,
// without coordinates in a unit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sansmesh::inline v1 {

/// A 2ᴺ-tree over a cube, N = 2, 3 or 4, as one flat array. Node 0 is the root; the 2ᴺ children of a node are
/// consecutive, and bit k of a child's number is its half along axis k. Cells are integers: block `cell` of level l is
/// the cube [cell, cell + 1]·2⁻ˡ, and the root is [0, 1]ᴺ.
template <int N>
class BlockTreeN {
 public:
  static constexpr int kMaxLevel = 16;                    ///< lattice coordinates stay within 20 bits
  static constexpr std::size_t kMostBlocks = 0x7fffffff;  ///< child indices have 31 bits
  static constexpr std::uint32_t kChildren = 1u << N;

  struct Block {
    std::int32_t first_child = -1;  ///< -1: a leaf
    std::uint8_t level = 0;
    std::array<std::uint32_t, N> cell{};
  };
  /// Like Block::cell, but may be outside the root.
  using Cell = std::array<std::int64_t, N>;

  /// A tree of one block.
  BlockTreeN() : blocks_(1) {}

  std::size_t size() const { return blocks_.size(); }
  const Block& operator[](std::size_t i) const { return blocks_[i]; }
  bool is_leaf(std::size_t i) const { return blocks_[i].first_child < 0; }
  int depth() const { return depth_; }  ///< deepest level present

  /// Divides a leaf into 2ᴺ blocks; returns the index of its first child. Throws ArgumentError beyond kMaxLevel,
  /// DataError beyond kMostBlocks.
  std::size_t subdivide(std::size_t i);

  /// Divides some leaves; returns their children, in order. Throws as subdivide().
  std::vector<std::uint32_t> subdivide_all(std::span<const std::uint32_t> leaves);

  /// Deepest block of at most `level` that contains this cell of that level; -1 outside the root.
  std::int64_t find(int level, const Cell& cell) const;

  /// True if the block at exactly this level and cell exists and is subdivided.
  bool subdivided(int level, const Cell& cell) const;

  /// Subdivides until blocks that share a corner, edge or face differ by at most one level.
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
