#include "sansmesh/search/equal_positions.h"

#include <algorithm>
#include <bit>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {

std::uint64_t position_hash(const Vec3f& p) {
  std::uint64_t hash = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const float c = p[k] + 0.0f;  // −0 becomes 0
    hash = (hash ^ std::bit_cast<std::uint32_t>(c)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash;
}

std::vector<std::uint32_t> first_equal_positions(std::span<const Vec3f> positions) {
  std::vector<KeyIndex> order(positions.size());
  parallel_for(0, order.size(), 8192, [&](std::size_t i) {
    order[i] = {position_hash(positions[i]), static_cast<unsigned>(i)};
  });
  parallel_sort(order);
  std::vector<std::uint32_t> first(positions.size());
  std::vector<std::uint32_t> distinct;  // first indices of the positions with the current hash: rarely more than one
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || order[i].key != order[i - 1].key) distinct.clear();
    const std::uint32_t index = order[i].index;
    first[index] = index;
    if (!is_finite(positions[index])) continue;
    const auto equal = std::find_if(distinct.begin(), distinct.end(),
                                    [&](std::uint32_t other) { return positions[other] == positions[index]; });
    if (equal == distinct.end())
      distinct.push_back(index);
    else
      first[index] = *equal;
  }
  return first;
}

}  // namespace sansmesh::inline v1
