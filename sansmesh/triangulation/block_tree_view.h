// Adapters of block trees to the interface of the J₁ᴬ triangulation.
#pragma once

#include "sansmesh/triangulation/block_tree.h"
#include "sansmesh/triangulation/j1a.h"

namespace sansmesh::inline v1 {

/// A BlockTreeN as a BlockView. Refers to the tree, which may change, must outlive this object and must be balanced at
/// each query.
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

/// The same for a BlockTree in space.
class BlockTreeView final : public BlockTreeNView<3> {
 public:
  explicit BlockTreeView(const BlockTree& tree) : BlockTreeNView<3>(tree), tree_(&tree) {}

  /// Position of a vertex in the unit of the tree.
  Vec3 position(const LatticeVertex<3>& v) const {
    const double unit = tree_->edge() / static_cast<double>(kLatticeEdge);
    const Vec3 offset{static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
    return tree_->lower() + offset * unit;
  }
  /// Converts a point in the unit of the tree to an argument of locate().
  std::array<double, 3> to_lattice(const Vec3& x) const {
    const Vec3 u = (x - tree_->lower()) / tree_->edge();
    return {u.x, u.y, u.z};
  }

 private:
  const BlockTree* tree_;
};

}  // namespace sansmesh::inline v1
