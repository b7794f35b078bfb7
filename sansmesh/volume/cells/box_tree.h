// Bounding-volume tree of boxes in double precision, eight children per node.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/search/box_levels.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Immutable after construction, safe from any thread. Boxes are kept in float, relative to the centre of all of them
/// and rounded outwards: results are complete, with few false positives.
class BoxTree {
 public:
  BoxTree() = default;
  /// `box(i)` of the items i < count; called twice for each, in parallel. Empty and non-finite boxes are never found.
  BoxTree(std::size_t count, const std::function<Box3(std::size_t)>& box);

  bool empty() const { return order_.empty(); }
  /// Replaces `items` by the items whose boxes meet `box`, in no particular order.
  void overlapping(const Box3& box, std::vector<std::uint32_t>& items) const;
  void containing(const Vec3& x, std::vector<std::uint32_t>& items) const { overlapping({x, x}, items); }

  static constexpr std::uint32_t kNone = 0xffffffffu;
  /// The item nearest to x by `squared_distance(i)`, which must not be below the squared distance to its box; among
  /// equally near ones the smallest index. Only items nearer than the root of `limit`; kNone if there is none. x must
  /// be finite.
  template <class SquaredDistance>
  std::uint32_t nearest(const Vec3& x, const SquaredDistance& squared_distance, double limit) const {
    std::uint32_t best = kNone;
    if (levels_.empty()) return best;
    const Vec3 q = (x - origin_) * scale_;
    struct Waiting {
      double distance;
      std::uint32_t level, node;
    };
    // Depth first, nearest child first: at most seven others wait on each of eleven levels.
    Waiting stack[96];
    std::size_t depth = 0;
    stack[depth++] = {0, static_cast<std::uint32_t>(levels_.size()), 0};
    while (depth > 0) {
      const Waiting top = stack[--depth];
      if (top.distance > limit) continue;
      if (top.level == 0) {
        const std::uint32_t item = order_[top.node];
        const double d = squared_distance(item);
        if (d < limit || (d == limit && item < best && best != kNone)) limit = d, best = item;
        continue;
      }
      double distances[kTreeWidth];
      std::size_t by_distance[kTreeWidth], count = 0;
      child_distances(levels_[top.level - 1][top.node], q, distances);
      for (std::size_t c = 0; c < kTreeWidth; ++c) {
        if (!(distances[c] <= limit) || std::isinf(distances[c])) continue;  // unused lanes are infinitely far away
        std::size_t at = count++;
        for (; at > 0 && distances[by_distance[at - 1]] < distances[c]; --at) by_distance[at] = by_distance[at - 1];
        by_distance[at] = c;
      }
      for (std::size_t k = 0; k < count; ++k)
        stack[depth++] = {distances[by_distance[k]], top.level - 1,
                          static_cast<std::uint32_t>(top.node * kTreeWidth + by_distance[k])};
    }
    return best;
  }

 private:
  /// Squared, in the unit of the input; infinite for unused lanes.
  void child_distances(const BoxNode& node, const Vec3& q, double* distances) const;

  Vec3 origin_;
  double scale_ = 1;  ///< tree coordinates are (x − origin) scale
  std::vector<std::uint32_t> order_;
  BoxLevels levels_;
};

}  // namespace sansmesh::inline v1
