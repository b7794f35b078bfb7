// Boxes in double precision and which of them are where: an eight-wide tree.
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

/// Built once, then asked from any thread. Boxes are kept in float, relative to the middle of all of them and rounded
/// outwards: what is found always includes what is there, and hardly more.
class BoxTree {
 public:
  BoxTree() = default;
  /// `box(i)` of the items i < count; called twice for each, in parallel. Empty boxes, and those that are not finite,
  /// are never found.
  BoxTree(std::size_t count, const std::function<Box3(std::size_t)>& box);

  bool empty() const { return order_.empty(); }
  /// Replaces `items` by those whose boxes meet `box`, in no particular order.
  void overlapping(const Box3& box, std::vector<std::uint32_t>& items) const;
  void containing(const Vec3& x, std::vector<std::uint32_t>& items) const { overlapping({x, x}, items); }

  static constexpr std::uint32_t kNone = 0xffffffffu;
  /// The item nearest to x, where `squared_distance(i)`, never less than that of its box, says how near it is; of
  /// equally near ones the least number. Only those nearer than the root of `limit`; kNone if there is none. x finite.
  template <class SquaredDistance>
  std::uint32_t nearest(const Vec3& x, const SquaredDistance& squared_distance, double limit) const {
    std::uint32_t best = kNone;
    if (levels_.empty()) return best;
    const Vec3 q = (x - origin_) * scale_;
    struct Waiting {
      double distance;
      std::uint32_t level, node;
    };
    // Depth first, the nearest child first: at most seven others wait on each of eleven levels.
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
        if (!(distances[c] <= limit) || std::isinf(distances[c]))
          continue;  // lanes that are not used are infinitely far
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
  /// Squared, in the unit of the input; infinite for lanes that are not used.
  void child_distances(const BoxNode& node, const Vec3& q, double* distances) const;

  Vec3 origin_;
  double scale_ = 1;  ///< coordinates of the tree are (x − origin) scale
  std::vector<std::uint32_t> order_;
  BoxLevels levels_;
};

}  // namespace sansmesh::inline v1
