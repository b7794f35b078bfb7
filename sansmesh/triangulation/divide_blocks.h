// Subdivision of the blocks of a tree, level by level.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

/// Subdivides blocks from the root on, for at most `levels` levels. `divides(block, scratch)` decides for each block
/// independently, on several threads; `scratch` is a reusable buffer of indices.
template <class Divides>
void divide_blocks(BlockTree& tree, int levels, const Divides& divides) {
  std::vector<std::uint32_t> level{0};
  for (int depth = 0; depth < levels && !level.empty(); ++depth) {
    std::vector<std::uint8_t> divided(level.size());
    parallel_ranges(0, level.size(), 64, [&](std::size_t first, std::size_t last) {
      std::vector<std::uint32_t> scratch;
      for (std::size_t i = first; i < last; ++i) divided[i] = divides(level[i], scratch);
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < level.size(); ++i)
      if (divided[i]) level[kept++] = level[i];
    level.resize(kept);
    level = tree.subdivide_all(level);
  }
}

}  // namespace sansmesh::inline v1
