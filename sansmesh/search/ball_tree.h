// Which balls touch a box: the query behind every sum over samples with supports of different size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/core/box.h"
#include "sansmesh/core/vec.h"

namespace sansmesh {

/// Built once, then asked from any thread. Balls keep the order in which they are given, which should be one where
/// consecutive balls lie close together (such as KdTree::order): the tree is made of runs of eight.
class BallTree {
 public:
  BallTree() = default;
  /// Arrays of equal length; finite centres, radii of at least 0. Copies what it needs.
  BallTree(std::span<const Vec3f> centers, std::span<const float> radii);

  std::size_t size() const { return size_; }

  /// Replaces `out` by the balls that touch the box (distance of the box to the centre <= radius), ascending.
  void touching(const Box3f& box, std::vector<std::uint32_t>& out) const;

  static constexpr std::size_t kWidth = 8;  ///< balls per leaf, boxes per node
  /// Unused lanes have negative radii.
  struct alignas(32) Leaf {
    float x[kWidth], y[kWidth], z[kWidth], radius[kWidth];
  };
  /// Boxes of up to eight children; unused lanes are empty.
  struct alignas(32) Node {
    float lower[3][kWidth], upper[3][kWidth];
  };

 private:
  std::size_t size_ = 0;
  std::vector<Leaf> leaves_;
  /// levels_[0][i] holds the boxes of leaves 8i .. 8i+7, levels_[l][i] those of levels_[l-1][8i .. 8i+7]; the last
  /// level has one node.
  std::vector<std::vector<Node>> levels_;
};

}  // namespace sansmesh
