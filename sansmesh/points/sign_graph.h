// Which of many ± signs agree, from votes of different weight between pairs of them.
#pragma once

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace sansmesh::inline v1 {

/// Union-find whose members know their sign relative to their root.
class SignForest {
 public:
  explicit SignForest(std::size_t n) : parent_(n), flip_(n), size_(n, 1) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  struct Root {
    std::uint32_t index;
    bool flip;  ///< the member's sign is opposite to the root's
  };
  Root find(std::uint32_t i) {
    std::uint32_t root = i;
    std::uint8_t flip = 0;
    while (parent_[root] != root) flip ^= flip_[root], root = parent_[root];
    // Everything on the way hangs directly below the root from now on.
    for (std::uint8_t f = flip; parent_[i] != root && i != root;) {
      const std::uint8_t own = flip_[i];
      flip_[i] = f;
      f ^= own;
      i = std::exchange(parent_[i], root);
    }
    return {root, flip != 0};
  }
  /// Joins the sets of a and b such that their signs are opposite or equal; no effect where they are joined already.
  void join(std::uint32_t a, std::uint32_t b, bool opposite) {
    Root ra = find(a), rb = find(b);
    if (ra.index == rb.index) return;
    if (size_[ra.index] < size_[rb.index]) std::swap(ra, rb);
    parent_[rb.index] = ra.index;
    flip_[rb.index] = static_cast<std::uint8_t>(ra.flip ^ rb.flip ^ opposite);
    size_[ra.index] += size_[rb.index];
  }
  /// Hangs every member directly below its root, in parallel.
  void flatten();
  /// As `find`, of a forest flattened since the last join: for many threads at once.
  Root flat_root(std::uint32_t i) const { return {parent_[i], flip_[i] != 0}; }
  std::size_t size() const { return parent_.size(); }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> flip_;
  std::vector<std::uint32_t> size_;
};

/// A vote on the signs of two nodes: positive = equal, negative = opposite. Whole numbers, so that sums do not depend
/// on the order in which they are formed.
struct SignVote {
  std::uint32_t a, b;
  std::int64_t weight;
};

/// Joins nodes in `forest` from the clearest majority to the least clear one; votes between the same two sets add up,
/// newly joined ones included (greedy additive edge contraction, Keuper et al. 2015). Votes refer to members.
void contract(SignForest& forest, const std::vector<SignVote>& votes);

}  // namespace sansmesh::inline v1
