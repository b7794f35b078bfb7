// What all trees here are: eight wide, made of runs of eight, and flat arrays level upon level.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {

constexpr std::size_t kTreeWidth = 8;  ///< children a node

/// The levels over `items`, from below: node n of level 0 stands for items 8n .. 8n+7, node n of level l for nodes
/// 8n .. 8n+7 of level l − 1; the last level has one node. No items have no levels. Items that are neighbours in the
/// list should be so in space. `make(siblings, level, node)` fills a node that stands for one to eight siblings and
/// returns what stands for it among the siblings of the level above. It is called in parallel.
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

/// Boxes of up to eight children side by side; unused lanes are empty boxes, infinitely far from anything.
struct alignas(64) BoxNode {
  float lower[3][kTreeWidth], upper[3][kTreeWidth];
};

using BoxLevels = std::vector<std::vector<BoxNode>>;

/// Each lane of level 0 is one of the boxes, each lane above the box of all that lies below.
BoxLevels box_levels(std::vector<Box3f> boxes);

}  // namespace sansmesh::inline v1
