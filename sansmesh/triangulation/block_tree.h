// The 2:1 balanced tree of cubic blocks that carries the J₁ᴬ triangulation (METHODS §3.2).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/core/box.h"
#include "sansmesh/core/vec.h"

namespace sansmesh {

/// Range of the depths that can be asked for, of trees of fits and of the blocks of meshes.
constexpr int kLeastDepth = 2, kMostDepth = 14;

/// An octree over a cube, as one flat array. Node 0 is the root; the eight children of a node are consecutive, in the
/// order x + 2y + 4z. Cells are integer: block (i, j, k) of level l is the cube lower + edge·2⁻ˡ·[(i,j,k),
/// (i+1,j+1,k+1)].
class BlockTree {
 public:
  static constexpr int kMaxLevel = 16;                    ///< lattice coordinates stay within 20 bits
  static constexpr std::size_t kMostBlocks = 0x7fffffff;  ///< children are found by 31 bits

  struct Block {
    std::int32_t first_child = -1;  ///< -1: a leaf
    std::uint8_t level = 0;
    std::array<std::uint32_t, 3> cell{};
  };

  /// A tree that is one block: the cube with this corner and edge length.
  BlockTree(const Vec3& lower, double edge) : lower_(lower), edge_(edge), blocks_(1) {}

  const Vec3& lower() const { return lower_; }
  double edge() const { return edge_; }
  Box3 bounds() const { return {lower_, lower_ + Vec3{edge_, edge_, edge_}}; }
  std::size_t size() const { return blocks_.size(); }
  const Block& operator[](std::size_t i) const { return blocks_[i]; }
  bool is_leaf(std::size_t i) const { return blocks_[i].first_child < 0; }
  int depth() const { return depth_; }  ///< deepest level present

  double block_edge(std::size_t i) const { return edge_ / static_cast<double>(1u << blocks_[i].level); }
  Vec3 block_center(std::size_t i) const;

  /// Cuts a leaf in eight; returns the index of its first child. Throws ArgumentError beyond kMaxLevel,
  /// DataError beyond kMostBlocks.
  std::size_t subdivide(std::size_t i);

  /// The deepest block of at most `level` that contains cell (i, j, k) of that level; -1 outside the root.
  std::int64_t find(int level, std::int64_t i, std::int64_t j, std::int64_t k) const;

  /// True if the block at exactly this level and cell exists and is subdivided.
  bool subdivided(int level, std::int64_t i, std::int64_t j, std::int64_t k) const;

  /// Subdivides until blocks that share a face, an edge or a corner differ by one level at most.
  void balance();

  /// Leaves in tree order (a space-filling order).
  std::vector<std::uint32_t> leaves() const;

 private:
  Vec3 lower_;
  double edge_;
  int depth_ = 0;
  std::vector<Block> blocks_;
};

}  // namespace sansmesh
