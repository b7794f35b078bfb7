// Determines consistent ± signs from weighted votes between pairs.
#pragma once

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace sansmesh::inline v1 {

/// Union-find whose members store their sign relative to the root.
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
    // Path compression: links every node on the path directly to the root.
    for (std::uint8_t f = flip; parent_[i] != root && i != root;) {
      const std::uint8_t own = flip_[i];
      flip_[i] = f;
      f ^= own;
      i = std::exchange(parent_[i], root);
    }
    return {root, flip != 0};
  }
  /// Joins the sets of a and b such that their signs are opposite or equal; no effect if they are already joined.
  void join(std::uint32_t a, std::uint32_t b, bool opposite) {
    Root ra = find(a), rb = find(b);
    if (ra.index == rb.index) return;
    if (size_[ra.index] < size_[rb.index]) std::swap(ra, rb);
    parent_[rb.index] = ra.index;
    flip_[rb.index] = static_cast<std::uint8_t>(ra.flip ^ rb.flip ^ opposite);
    size_[ra.index] += size_[rb.index];
  }
  /// Links every member directly to its root, in parallel.
  void flatten();
  /// Same as `find`, for a forest flattened since the last join; thread-safe.
  Root flat_root(std::uint32_t i) const { return {parent_[i], flip_[i] != 0}; }
  std::size_t size() const { return parent_.size(); }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> flip_;
  std::vector<std::uint32_t> size_;
};

/// Vote on the signs of two nodes: positive = equal, negative = opposite. Integer, so that sums do not depend on their
/// order.
struct SignVote {
  std::uint32_t a, b;
  std::int64_t weight;
};

/// Joins nodes in `forest` from the largest to the smallest majority; votes between the same two sets are summed, also
/// for newly joined sets (greedy additive edge contraction [keuper2015]). Votes refer to members.
void contract(SignForest& forest, const std::vector<SignVote>& votes);

}  // namespace sansmesh::inline v1
