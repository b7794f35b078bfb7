// A slow reference implementation of a 2:1 balanced tree: the set of its subdivided blocks.
#pragma once

#include <array>
#include <cstdlib>
#include <random>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "sansmesh/triangulation/j1a.h"

namespace sansmesh::inline v1 {

/// Balanced over faces and (in three dimensions) edges, but not over corners, as the triangulation requires.
template <int N>
class BalancedTree final : public BlockView<N> {
 public:
  using Block = std::pair<int, BlockCell<N>>;

  /// roots[k] blocks of level 0 along axis k.
  explicit BalancedTree(const BlockCell<N>& roots) : roots_(roots) {}

  bool exists(int level, const BlockCell<N>& cell) const {
    for (std::size_t k = 0; k < N; ++k)
      if (cell[k] < 0 || cell[k] >> level >= roots_[k]) return false;
    return level == 0 || inner_.count({level - 1, halved(cell)}) > 0;
  }
  bool subdivided(int level, const BlockCell<N>& cell) const override { return inner_.count({level, cell}) > 0; }
  bool is_leaf(int level, const BlockCell<N>& cell) const override {
    return exists(level, cell) && !subdivided(level, cell);
  }
  const BlockCell<N>& roots() const { return roots_; }

  /// Subdivides a block, and first all blocks that balance requires.
  void subdivide(int level, const BlockCell<N>& cell) {
    for (std::size_t k = 0; k < N; ++k)
      if (cell[k] < 0 || cell[k] >> level >= roots_[k]) return;
    if (subdivided(level, cell)) return;
    if (level > 0) {
      // All blocks of this level that share a face or an edge with it must exist: their parents are subdivided.
      int size = 1;
      for (int k = 0; k < N; ++k) size *= 3;
      for (int index = 0; index < size; ++index) {
        BlockCell<N> other = cell;
        int moved = 0;
        for (int k = 0, rest = index; k < N; ++k, rest /= 3) {
          other[static_cast<std::size_t>(k)] += rest % 3 - 1;
          moved += std::abs(rest % 3 - 1);
        }
        if (moved < N) subdivide(level - 1, halved(other));
      }
    }
    inner_.insert({level, cell});
  }

  /// Subdivides towards random points, and sometimes a random block.
  static BalancedTree random(unsigned seed, const BlockCell<N>& roots, int depth, int points) {
    std::mt19937 generator(seed);
    BalancedTree tree(roots);
    for (int n = 0; n < points; ++n) {
      const int deepest = 1 + static_cast<int>(generator() % static_cast<unsigned>(depth));
      BlockCell<N> cell;
      for (std::size_t k = 0; k < N; ++k)
        cell[k] = static_cast<std::int32_t>(generator() % static_cast<unsigned>(roots[k] << (deepest - 1)));
      tree.subdivide(deepest - 1, cell);
    }
    return tree;
  }

  std::vector<Block> leaves() const {
    std::vector<Block> result;
    BlockCell<N> cell{};
    for (bool more = true; more;) {
      collect(0, cell, result);
      more = false;
      for (std::size_t k = 0; k < N && !more; ++k) {
        more = ++cell[k] < roots_[k];
        if (!more) cell[k] = 0;
      }
    }
    return result;
  }

 private:
  static BlockCell<N> halved(BlockCell<N> cell) {
    for (auto& c : cell) c >>= 1;
    return cell;
  }
  void collect(int level, const BlockCell<N>& cell, std::vector<Block>& out) const {
    if (!subdivided(level, cell)) return out.push_back({level, cell});
    for (unsigned child = 0; child < 1u << N; ++child) {
      BlockCell<N> c = cell;
      for (std::size_t k = 0; k < N; ++k) c[k] = 2 * c[k] + static_cast<std::int32_t>(child >> k & 1u);
      collect(level + 1, c, out);
    }
  }

  BlockCell<N> roots_;
  std::set<Block> inner_;
};

/// One block of level 0.
template <int N>
BlockCell<N> one_root() {
  BlockCell<N> roots;
  roots.fill(1);
  return roots;
}

/// Orders simplices in sets.
template <int N>
auto key(const Simplex<N>& s) {
  return std::tuple(s.level, s.cell, s.axis, s.sign, s.extra, s.steps);
}

}  // namespace sansmesh::inline v1
