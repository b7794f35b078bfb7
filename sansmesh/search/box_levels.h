// Eight-wide trees over runs of eight items, stored as one flat array per level.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {

constexpr std::size_t kTreeWidth = 8;  ///< children per node

/// Builds the levels over `items` from the bottom: node n of level 0 covers items 8n .. 8n+7, node n of level l covers
/// nodes 8n .. 8n+7 of level l − 1, and the last level has one node. No levels if there are no items. Neighbours in the
/// list should be neighbours in space. `make(siblings, level, node)` fills a node over one to eight siblings and
/// returns the item that represents it in the level above. It is called in parallel.
template <class Node, class Item, class Make>
std::vector<std::vector<Node>> eight_wide_levels(std::vector<Item> items, const Make& make) {
  std::vector<std::vector<Node>> levels;
  while (!items.empty()) {
    std::vector<Node> nodes((items.size() + kTreeWidth - 1) / kTreeWidth);
    std::vector<Item> above(nodes.size());
    parallel_for(0, nodes.size(), 1024, [&](std::size_t n) {
      const std::size_t first = n * kTreeWidth;
      const std::size_t count = items.size() - first < kTreeWidth ? items.size() - first : kTreeWidth;
      above[n] = make(std::span<const Item>(items).subspan(first, count), levels.size(), nodes[n]);
    });
    levels.push_back(std::move(nodes));
    if (above.size() == 1) break;
    items = std::move(above);
  }
  return levels;
}

/// Boxes of up to eight children; unused lanes are empty boxes, infinitely far from every point.
struct alignas(64) BoxNode {
  float lower[3][kTreeWidth], upper[3][kTreeWidth];
};

using BoxLevels = std::vector<std::vector<BoxNode>>;

/// Each lane of level 0 is one of the boxes; each lane above is the bounding box of its subtree.
BoxLevels box_levels(std::vector<Box3f> boxes);

}  // namespace sansmesh::inline v1
