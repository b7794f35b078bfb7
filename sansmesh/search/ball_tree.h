// Which balls touch a box: the query behind every sum over samples with supports of different size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/search/box_levels.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

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
  /// The same, but false where there are more than `most`; `out` then holds some of them.
  bool touching(const Box3f& box, std::size_t most, std::vector<std::uint32_t>& out) const;

  /// Unused lanes have negative radii.
  struct alignas(32) Leaf {
    float x[kTreeWidth], y[kTreeWidth], z[kTreeWidth], radius[kTreeWidth];
  };

 private:
  std::size_t size_ = 0;
  std::vector<Leaf> leaves_;
  BoxLevels levels_;  ///< over the leaves
};

}  // namespace sansmesh::inline v1
