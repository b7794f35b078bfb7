#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/search/kd_tree_kernels.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h (Highway).
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "sansmesh/search/box_node-inl.h"
#include "sansmesh/search/kd_tree_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
constexpr std::size_t kLeaf = kTreeWidth;

// Squared distances of q to the points of a leaf; returns the set of those <= limit. Rounding is monotone and the
// operations equal those for boxes, so no point is nearer than its box, not even in the last bit.
HWY_INLINE std::uint32_t LeafDistances(const KdTreeLeaf& leaf, const Vec3f& q, float limit, float* distances) {
  const Tag d;
  const V worst = hn::Set(d, limit);
  std::uint32_t hits = 0;
  for (std::size_t i = 0; i < kLeaf; i += kLanes) {
    const V d2 = SquaredLength(hn::Sub(hn::LoadU(d, leaf.x + i), hn::Set(d, q.x)),
                               hn::Sub(hn::LoadU(d, leaf.y + i), hn::Set(d, q.y)),
                               hn::Sub(hn::LoadU(d, leaf.z + i), hn::Set(d, q.z)));
    hn::StoreU(d2, d, distances + i);
    hits |= Bits(hn::Le(d2, worst), i);
  }
  return hits;
}

// Sorts the children in `hits`, nearest first; returns their number.
HWY_INLINE std::size_t SortHits(std::uint32_t hits, const float* distances, std::uint64_t* sorted) {
  std::size_t n = 0;
  for (; hits; hits &= hits - 1) {
    const auto c = static_cast<std::size_t>(std::countr_zero(hits));
    const std::uint64_t key = (std::uint64_t{std::bit_cast<std::uint32_t>(distances[c])} << 32) | c;
    std::size_t j = n++;
    for (; j > 0 && sorted[j - 1] > key; --j) sorted[j] = sorted[j - 1];
    sorted[j] = key;
  }
  return n;
}

constexpr std::size_t kManyNeighbours = 48;  ///< from here on, a search and a block move are fastest

HWY_INLINE float DistanceOf(std::uint64_t key) { return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32)); }

// Finds the smallest keys. kSlots: the lower half of a key is the slot, otherwise the caller's index.
template <bool kSlots>
class Search {
 public:
  Search(const KdTreeView& tree, const Vec3f& q, std::span<NeighbourKey> keys)
      : tree_(tree), q_(q), keys_(keys.data()), last_(keys.size() - 1) {
    for (NeighbourKey& key : keys) key = kNoNeighbour;
  }

  void Leaf(std::size_t l) {
    float distances[kLeaf];
    const KdTreeLeaf& leaf = tree_.leaves[l];
    std::uint32_t hits = LeafDistances(leaf, q_, DistanceOf(keys_[last_]), distances);
    for (; hits; hits &= hits - 1) {
      const auto c = static_cast<std::size_t>(std::countr_zero(hits));
      const std::uint32_t index = kSlots ? static_cast<std::uint32_t>(l * kLeaf + c) : leaf.index[c];
      const NeighbourKey key = (NeighbourKey{std::bit_cast<std::uint32_t>(distances[c])} << 32) | index;
      if (key < keys_[last_]) Insert(key);
    }
  }

  void Node(std::size_t level, std::size_t node, std::size_t except = kLeaf) {
    float distances[kLeaf];
    std::uint64_t sorted[kLeaf];
    std::uint32_t hits = Within(tree_.levels[level][node], q_, DistanceOf(keys_[last_]), distances);
    if (except < kLeaf) hits &= ~(1u << except);
    const std::size_t n = SortHits(hits, distances, sorted);
    for (std::size_t i = 0; i < n; ++i) {
      if (!(DistanceOf(sorted[i]) <= DistanceOf(keys_[last_]))) break;
      const std::size_t child = node * kLeaf + (sorted[i] & 7);
      // At equal distance lower slots win, and a child contains no slot below its first: this bounds the search among
      // many coincident points.
      if (kSlots && ((sorted[i] >> 32 << 32) | child << (3 * (level + 1))) >= keys_[last_]) break;
      if (level == 0)
        Leaf(child);
      else
        Node(level - 1, child);
    }
  }

 private:
  HWY_INLINE void Insert(NeighbourKey key) {
    if (last_ >= kManyNeighbours) {
      NeighbourKey* at = std::upper_bound(keys_, keys_ + last_, key);
      std::memmove(at + 1, at, static_cast<std::size_t>(keys_ + last_ - at) * sizeof(NeighbourKey));
      *at = key;
      return;
    }
    std::size_t j = last_;
    for (; j > 0 && keys_[j - 1] > key; --j) keys_[j] = keys_[j - 1];
    keys_[j] = key;
  }

  KdTreeView tree_;
  Vec3f q_;
  NeighbourKey* keys_;
  std::size_t last_;
};

void NearestKeys(const KdTreeView& tree, const Vec3f& q, std::span<NeighbourKey> keys) {
  Search<false> search(tree, q, keys);
  search.Node(tree.levels.size() - 1, 0);
}

void NearestKeysOfSlot(const KdTreeView& tree, std::uint32_t slot, std::span<NeighbourKey> keys) {
  std::size_t at = slot / kLeaf;
  const KdTreeLeaf& leaf = tree.leaves[at];
  const std::size_t lane = slot % kLeaf;
  Search<true> search(tree, {leaf.x[lane], leaf.y[lane], leaf.z[lane]}, keys);
  search.Leaf(at);
  for (std::size_t level = 0; level < tree.levels.size(); ++level) {
    search.Node(level, at / kLeaf, at % kLeaf);
    at /= kLeaf;
  }
}

template <class Hit>
void ForEachWithin(const KdTreeView& tree, const Vec3f& q, float r2, std::size_t level, std::size_t node,
                   const Hit& hit) {
  float distances[kLeaf];
  std::uint32_t hits = Within(tree.levels[level][node], q, r2, distances);
  for (; hits; hits &= hits - 1) {
    const std::size_t child = node * kLeaf + static_cast<std::size_t>(std::countr_zero(hits));
    if (level > 0) {
      ForEachWithin(tree, q, r2, level - 1, child, hit);
    } else {
      const std::uint32_t points = LeafDistances(tree.leaves[child], q, r2, distances);
      hit(tree.leaves[child], points, distances);
    }
  }
}

void AppendWithin(const KdTreeView& tree, const Vec3f& q, float r2, std::vector<Neighbour>& out) {
  ForEachWithin(tree, q, r2, tree.levels.size() - 1, 0,
                [&](const KdTreeLeaf& leaf, std::uint32_t hits, const float* distances) {
                  for (; hits; hits &= hits - 1) {
                    const auto c = static_cast<std::size_t>(std::countr_zero(hits));
                    out.push_back({distances[c], leaf.index[c]});
                  }
                });
}

std::size_t CountWithin(const KdTreeView& tree, const Vec3f& q, float r2) {
  std::size_t count = 0;
  ForEachWithin(tree, q, r2, tree.levels.size() - 1, 0, [&](const KdTreeLeaf&, std::uint32_t hits, const float*) {
    count += static_cast<std::size_t>(std::popcount(hits));
  });
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(NearestKeys);
HWY_EXPORT(NearestKeysOfSlot);
HWY_EXPORT(AppendWithin);
HWY_EXPORT(CountWithin);

void nearest_keys(const KdTreeView& tree, const Vec3f& q, std::span<NeighbourKey> keys) {
  HWY_DYNAMIC_DISPATCH(NearestKeys)(tree, q, keys);
}
void nearest_keys_of_slot(const KdTreeView& tree, std::uint32_t slot, std::span<NeighbourKey> keys) {
  HWY_DYNAMIC_DISPATCH(NearestKeysOfSlot)(tree, slot, keys);
}
void append_within(const KdTreeView& tree, const Vec3f& q, float r2, std::vector<Neighbour>& out) {
  HWY_DYNAMIC_DISPATCH(AppendWithin)(tree, q, r2, out);
}
std::size_t count_within(const KdTreeView& tree, const Vec3f& q, float r2) {
  return HWY_DYNAMIC_DISPATCH(CountWithin)(tree, q, r2);
}

}  // namespace sansmesh::inline v1::detail
#endif
