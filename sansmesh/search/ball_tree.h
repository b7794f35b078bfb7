// Finds the balls that touch a box: the query of every sum over samples with supports of different sizes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/search/box_levels.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Built once, then queried from any thread. Balls keep their given order, in which consecutive balls should be close
/// together (for example KdTree::order): the tree groups runs of eight.
class BallTree {
 public:
  BallTree() = default;
  /// Arrays of equal length; finite centres, radii >= 0. Copies the data.
  BallTree(std::span<const Vec3f> centers, std::span<const float> radii);

  std::size_t size() const { return size_; }

  /// Replaces `out` by the balls that touch the box (distance of the box to the centre <= radius), ascending.
  void touching(const Box3f& box, std::vector<std::uint32_t>& out) const;
  /// Same, but returns false if there are more than `most`; `out` then holds some of them.
  bool touching(const Box3f& box, std::size_t most, std::vector<std::uint32_t>& out) const;

  /// Leaf of eight balls; unused lanes have negative radii.
  struct alignas(32) Leaf {
    float x[kTreeWidth], y[kTreeWidth], z[kTreeWidth], radius[kTreeWidth];
  };

 private:
  std::size_t size_ = 0;
  std::vector<Leaf> leaves_;
  BoxLevels levels_;  ///< levels over the leaves
};

}  // namespace sansmesh::inline v1
