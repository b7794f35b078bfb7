// Block trees as the J₁ᴬ triangulation sees them.
#pragma once

#include "sansmesh/triangulation/block_tree.h"
#include "sansmesh/triangulation/j1a.h"

namespace sansmesh::inline v1 {

/// Such a tree as the triangulation sees it. Refers to the tree, which must be balanced when it is asked, must outlive
/// this and may change.
template <int N>
class BlockTreeNView : public BlockView<N> {
 public:
  explicit BlockTreeNView(const BlockTreeN<N>& tree) : tree_(&tree) {}

  bool is_leaf(int level, const BlockCell<N>& cell) const override {
    const std::int64_t b = tree_->find(level, wide(cell));
    return b >= 0 && (*tree_)[static_cast<std::size_t>(b)].level == level &&
           tree_->is_leaf(static_cast<std::size_t>(b));
  }
  bool subdivided(int level, const BlockCell<N>& cell) const override { return tree_->subdivided(level, wide(cell)); }

 private:
  static typename BlockTreeN<N>::Cell wide(const BlockCell<N>& cell) {
    typename BlockTreeN<N>::Cell result;
    for (std::size_t k = 0; k < N; ++k) result[k] = cell[k];
    return result;
  }

  const BlockTreeN<N>* tree_;
};

/// A tree in space.
class BlockTreeView final : public BlockTreeNView<3> {
 public:
  explicit BlockTreeView(const BlockTree& tree) : BlockTreeNView<3>(tree), tree_(&tree) {}

  /// Where a vertex lies, in the unit of the tree.
  Vec3 position(const LatticeVertex<3>& v) const {
    const double unit = tree_->edge() / static_cast<double>(kLatticeEdge);
    const Vec3 offset{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
    return tree_->lower() + offset * unit;
  }
  /// The argument of locate() for a point in the unit of the tree.
  std::array<double, 3> to_lattice(const Vec3& x) const {
    const Vec3 u = (x - tree_->lower()) / tree_->edge();
    return {u.x, u.y, u.z};
  }

 private:
  const BlockTree* tree_;
};

}  // namespace sansmesh::inline v1
