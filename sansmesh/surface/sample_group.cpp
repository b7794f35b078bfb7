#include "sansmesh/surface/sample_group.h"

#include <cmath>

namespace sansmesh::detail {
namespace {

/// Spreads the lower ten bits so that two zeros stand between neighbours.
std::uint32_t spread_bits(std::uint32_t v) {
  v = (v | (v << 16)) & 0x030000FFu;
  v = (v | (v << 8)) & 0x0300F00Fu;
  v = (v | (v << 4)) & 0x030C30C3u;
  return (v | (v << 2)) & 0x09249249u;
}

}  // namespace

void order_batch(std::span<const Vec3> x, double cell, std::vector<std::uint64_t>& order) {
  order.clear();
  Box3 box;
  for (const Vec3& p : x)
    if (is_finite(p)) box.extend(p);
  const Vec3 size = box.empty() ? Vec3{} : box.size();
  const double largest = std::max({size.x, size.y, size.z});
  // Half the width of a group, as far as ten bits an axis go.
  const double scale = 1 / std::max({0.5 * cell, largest / 1023, 1e-300});
  const bool sorted = largest <= cell;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!is_finite(x[i])) continue;
    std::uint64_t key = 0;
    if (!sorted) {
      const Vec3 at = (x[i] - box.lower) * scale;
      key = spread_bits(static_cast<std::uint32_t>(at.x)) | (spread_bits(static_cast<std::uint32_t>(at.y)) << 1) |
            (spread_bits(static_cast<std::uint32_t>(at.z)) << 2);
    }
    order.push_back((key << 32) | i);
  }
  if (!sorted) std::sort(order.begin(), order.end());
}

}  // namespace sansmesh::detail
