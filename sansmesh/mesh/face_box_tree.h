// Tree of boxes for queries of those that touch a box.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/boxes.h"

namespace sansmesh::inline v1 {

/// Boxes in the order of a space-filling curve, under a binary tree of bounding boxes.
class FaceBoxTree {
 public:
  explicit FaceBoxTree(std::span<const Box3f> boxes);

  /// Calls visit(i) for each box i that touches `query`, in an order that depends only on the boxes, until a call
  /// returns false. Returns whether none did.
  template <class Visit>
  bool visit(const Box3f& query, const Visit& visit) const {
    if (order_.empty()) return true;
    std::size_t open[64];
    std::size_t count = 0;
    open[count++] = 1;
    while (count > 0) {
      const std::size_t node = open[--count];
      if (!touch(node_[node], query)) continue;
      if (node < leaves_) {
        open[count++] = 2 * node + 1;
        open[count++] = 2 * node;
        continue;
      }
      const std::size_t first = (node - leaves_) * kLeaf;
      for (std::size_t i = first; i < first + kLeaf && i < order_.size(); ++i)
        if (touch(box_[i], query) && !visit(order_[i])) return false;
    }
    return true;
  }

 private:
  static constexpr std::size_t kLeaf = 4;
  std::vector<std::uint32_t> order_;
  std::vector<Box3f> box_;   ///< in this order
  std::vector<Box3f> node_;  ///< node i has the children 2i and 2i + 1
  std::size_t leaves_ = 1;
};

}  // namespace sansmesh::inline v1
