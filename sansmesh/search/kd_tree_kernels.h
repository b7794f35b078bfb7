// Nodes of KdTree, and its queries on plain arrays: compiled for every instruction set, selected at run time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/search/box_levels.h"
#include "sansmesh/search/neighbour.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Leaf of up to eight points; unused lanes are infinitely far away.
struct alignas(64) KdTreeLeaf {
  float x[kTreeWidth], y[kTreeWidth], z[kTreeWidth];
  std::uint32_t index[kTreeWidth];  ///< the caller's index
};

struct KdTreeView {
  const KdTreeLeaf* leaves;
  const BoxLevels& levels;  ///< levels over the leaves
};

/// Distance bits in the upper half, index in the lower: ordered like Neighbour, since distances are not negative.
using NeighbourKey = std::uint64_t;
constexpr NeighbourKey kNoNeighbour = (NeighbourKey{0x7f7fffffu} << 32) | 0xffffffffu;  // distance FLT_MAX

/// Writes the keys.size() smallest keys (caller's indices) in ascending order; kNoNeighbour if there are fewer.
void nearest_keys(const KdTreeView& tree, const Vec3f& q, std::span<NeighbourKey> keys);
/// Same, for the point in `slot`, with slots as indices; starts at its leaf and goes upwards.
void nearest_keys_of_slot(const KdTreeView& tree, std::uint32_t slot, std::span<NeighbourKey> keys);
/// Appends all points with squared distance <= r2.
void append_within(const KdTreeView& tree, const Vec3f& q, float r2, std::vector<Neighbour>& out);
std::size_t count_within(const KdTreeView& tree, const Vec3f& q, float r2);

}  // namespace sansmesh::inline v1::detail
