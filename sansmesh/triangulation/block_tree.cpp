#include "sansmesh/triangulation/block_tree.h"

#include "sansmesh/core/error.h"

namespace sansmesh {

Vec3 BlockTree::block_center(std::size_t i) const {
  const Block& b = blocks_[i];
  const double h = block_edge(i);
  return lower_ + Vec3{(b.cell[0] + 0.5) * h, (b.cell[1] + 0.5) * h, (b.cell[2] + 0.5) * h};
}

std::size_t BlockTree::subdivide(std::size_t i) {
  if (!is_leaf(i)) return static_cast<std::size_t>(blocks_[i].first_child);
  if (blocks_[i].level >= kMaxLevel) throw ArgumentError("block tree: deeper than 16 levels");
  const std::size_t first = blocks_.size();
  if (first + 8 > kMostBlocks) throw DataError("block tree: more blocks than can be counted");
  const Block parent = blocks_[i];
  blocks_[i].first_child = static_cast<std::int32_t>(first);
  for (unsigned c = 0; c < 8; ++c) {
    Block child;
    child.level = static_cast<std::uint8_t>(parent.level + 1);
    child.cell = {2 * parent.cell[0] + (c & 1u), 2 * parent.cell[1] + (c >> 1 & 1u), 2 * parent.cell[2] + (c >> 2)};
    blocks_.push_back(child);
  }
  depth_ = std::max(depth_, parent.level + 1);
  return first;
}

std::int64_t BlockTree::find(int level, std::int64_t i, std::int64_t j, std::int64_t k) const {
  const std::int64_t n = std::int64_t{1} << level;
  if (i < 0 || j < 0 || k < 0 || i >= n || j >= n || k >= n) return -1;
  std::size_t at = 0;
  for (int l = level - 1; l >= 0; --l) {
    const std::int32_t first = blocks_[at].first_child;
    if (first < 0) break;
    at = static_cast<std::size_t>(first) +
         static_cast<std::size_t>((i >> l & 1) | (j >> l & 1) << 1 | (k >> l & 1) << 2);
  }
  return static_cast<std::int64_t>(at);
}

bool BlockTree::subdivided(int level, std::int64_t i, std::int64_t j, std::int64_t k) const {
  const std::int64_t b = find(level, i, j, k);
  return b >= 0 && blocks_[static_cast<std::size_t>(b)].level == level &&
         blocks_[static_cast<std::size_t>(b)].first_child >= 0;
}

void BlockTree::balance() {
  // A subdivided block of level l needs all its neighbours of level l to exist. Those are created by subdividing blocks
  // of level l - 1, which come up when that level is treated: one sweep from the deepest level upward is enough.
  std::vector<std::vector<std::uint32_t>> inner(static_cast<std::size_t>(depth_) + 1);
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    if (!is_leaf(b)) inner[blocks_[b].level].push_back(static_cast<std::uint32_t>(b));
  for (int l = depth_ - 1; l > 0; --l) {
    for (std::size_t n = 0; n < inner[static_cast<std::size_t>(l)].size(); ++n) {
      const auto cell = blocks_[inner[static_cast<std::size_t>(l)][n]].cell;
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const std::int64_t i = std::int64_t{cell[0]} + dx, j = std::int64_t{cell[1]} + dy,
                               k = std::int64_t{cell[2]} + dz;
            std::int64_t at = find(l, i, j, k);
            while (at >= 0 && blocks_[static_cast<std::size_t>(at)].level < l) {
              inner[blocks_[static_cast<std::size_t>(at)].level].push_back(static_cast<std::uint32_t>(at));
              subdivide(static_cast<std::size_t>(at));
              at = find(l, i, j, k);
            }
          }
    }
  }
}

std::vector<std::uint32_t> BlockTree::leaves() const {
  std::vector<std::uint32_t> result;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t b = stack.back();
    stack.pop_back();
    if (is_leaf(b)) {
      result.push_back(b);
    } else {
      for (int c = 7; c >= 0; --c) stack.push_back(static_cast<std::uint32_t>(blocks_[b].first_child + c));
    }
  }
  return result;
}

}  // namespace sansmesh
