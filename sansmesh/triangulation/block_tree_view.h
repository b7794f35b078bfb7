// A block tree as the J₁ᴬ triangulation sees it.
#pragma once

#include "sansmesh/triangulation/block_tree.h"
#include "sansmesh/triangulation/j1a.h"

namespace sansmesh {

/// Refers to a balanced tree, which must outlive it and may change.
class BlockTreeView final : public BlockView<3> {
 public:
  explicit BlockTreeView(const BlockTree& tree) : tree_(&tree) {}

  bool is_leaf(int level, const BlockCell<3>& cell) const override {
    const std::int64_t b = tree_->find(level, cell[0], cell[1], cell[2]);
    return b >= 0 && (*tree_)[static_cast<std::size_t>(b)].level == level &&
           tree_->is_leaf(static_cast<std::size_t>(b));
  }
  bool subdivided(int level, const BlockCell<3>& cell) const override {
    return tree_->subdivided(level, cell[0], cell[1], cell[2]);
  }

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

}  // namespace sansmesh
