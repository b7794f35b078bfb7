#include "sansmesh/mesh/repair/same_places.h"

#include <cstring>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

std::uint64_t place_key(const Vec3f& p) {
  std::uint64_t key = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const float value = p[k] + 0.0f;  // turns -0 into 0
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    key = (key ^ bits) * 0x9E3779B97F4A7C15u;
    key ^= key >> 31;
  }
  return key;
}

}  // namespace

std::vector<std::uint32_t> first_at_place(std::span<const Vec3f> positions) {
  std::vector<KeyIndex> order(positions.size());
  parallel_for(0, order.size(), 8192, [&](std::size_t i) {
    order[i] = {place_key(positions[i]), static_cast<unsigned>(i)};
  });
  parallel_sort(order);
  std::vector<std::uint32_t> first(positions.size());
  for (std::size_t i = 0, group = 0; i < order.size(); ++i) {
    // Different places with the same key (one pair in 2^64) are only not joined.
    if (order[i].key != order[group].key || !(positions[order[i].index] == positions[order[group].index])) group = i;
    first[order[i].index] = order[group].index;
  }
  return first;
}

}  // namespace sansmesh::inline v1
