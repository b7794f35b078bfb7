#include "sansmesh/triangulation/block_tree_n.h"

#include <algorithm>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

template <int N>
std::size_t BlockTreeN<N>::subdivide(std::size_t i) {
  if (!is_leaf(i)) return static_cast<std::size_t>(blocks_[i].first_child);
  if (blocks_[i].level >= kMaxLevel) throw ArgumentError("block tree: deeper than 16 levels");
  const std::size_t first = blocks_.size();
  if (first + kChildren > kMostBlocks) throw DataError("block tree: too many blocks");
  const Block parent = blocks_[i];
  blocks_[i].first_child = static_cast<std::int32_t>(first);
  for (unsigned c = 0; c < kChildren; ++c) {
    Block child;
    child.level = static_cast<std::uint8_t>(parent.level + 1);
    for (std::size_t k = 0; k < N; ++k) child.cell[k] = 2 * parent.cell[k] + (c >> k & 1u);
    blocks_.push_back(child);
  }
  depth_ = std::max(depth_, parent.level + 1);
  return first;
}

template <int N>
std::vector<std::uint32_t> BlockTreeN<N>::subdivide_all(std::span<const std::uint32_t> leaves) {
  std::vector<std::uint32_t> children;
  children.reserve(kChildren * leaves.size());
  for (const std::uint32_t leaf : leaves) {
    const auto first = static_cast<std::uint32_t>(subdivide(leaf));
    for (std::uint32_t c = 0; c < kChildren; ++c) children.push_back(first + c);
  }
  return children;
}

template <int N>
std::int64_t BlockTreeN<N>::find(int level, const Cell& cell) const {
  const std::int64_t n = std::int64_t{1} << level;
  for (const std::int64_t c : cell)
    if (c < 0 || c >= n) return -1;
  std::size_t at = 0;
  for (int l = level - 1; l >= 0; --l) {
    const std::int32_t first = blocks_[at].first_child;
    if (first < 0) break;
    std::int64_t child = 0;
    for (std::size_t k = 0; k < N; ++k) child |= (cell[k] >> l & 1) << k;
    at = static_cast<std::size_t>(first) + static_cast<std::size_t>(child);
  }
  return static_cast<std::int64_t>(at);
}

template <int N>
bool BlockTreeN<N>::subdivided(int level, const Cell& cell) const {
  const std::int64_t b = find(level, cell);
  return b >= 0 && blocks_[static_cast<std::size_t>(b)].level == level &&
         blocks_[static_cast<std::size_t>(b)].first_child >= 0;
}

template <int N>
void BlockTreeN<N>::balance() {
  // A subdivided block of level l needs all its neighbours of level l. Those are created by subdividing blocks of level
  // l - 1, which are treated with that level: one sweep from the deepest level upward is enough.
  int neighbours = 1;
  for (int k = 0; k < N; ++k) neighbours *= 3;
  std::vector<std::vector<std::uint32_t>> inner(static_cast<std::size_t>(depth_) + 1);
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    if (!is_leaf(b)) inner[blocks_[b].level].push_back(static_cast<std::uint32_t>(b));
  for (int l = depth_ - 1; l > 0; --l) {
    for (std::size_t n = 0; n < inner[static_cast<std::size_t>(l)].size(); ++n) {
      const auto cell = blocks_[inner[static_cast<std::size_t>(l)][n]].cell;
      for (int index = 0; index < neighbours; ++index) {
        Cell other;
        int rest = index;
        for (std::size_t k = 0; k < N; ++k, rest /= 3) other[k] = std::int64_t{cell[k]} + rest % 3 - 1;
        std::int64_t at = find(l, other);
        while (at >= 0 && blocks_[static_cast<std::size_t>(at)].level < l) {
          inner[blocks_[static_cast<std::size_t>(at)].level].push_back(static_cast<std::uint32_t>(at));
          subdivide(static_cast<std::size_t>(at));
          at = find(l, other);
        }
      }
    }
  }
}

template <int N>
std::vector<std::uint32_t> BlockTreeN<N>::leaves() const {
  std::vector<std::uint32_t> result;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t b = stack.back();
    stack.pop_back();
    if (is_leaf(b)) {
      result.push_back(b);
    } else {
      for (std::uint32_t c = kChildren; c-- > 0;)
        stack.push_back(static_cast<std::uint32_t>(blocks_[b].first_child) + c);
    }
  }
  return result;
}

template class BlockTreeN<2>;
template class BlockTreeN<3>;
template class BlockTreeN<4>;

}  // namespace sansmesh::inline v1
