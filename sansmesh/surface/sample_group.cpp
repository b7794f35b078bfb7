#include "sansmesh/surface/sample_group.h"

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/morton.h"

namespace sansmesh::inline v1::detail {

void order_batch(std::span<const Vec3> x, double cell, std::vector<std::uint64_t>& order) {
  order.clear();
  const Box3 box = finite_bounds(x);
  const Vec3 size = box.empty() ? Vec3{} : box.size();
  const double largest = std::max({size.x, size.y, size.z});
  // Half the width of a group, within the range of ten bits per axis.
  const double scale = 1 / std::max({0.5 * cell, largest / 1023, 1e-300});
  const bool sorted = largest <= cell;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!is_finite(x[i])) continue;
    std::uint64_t key = 0;
    if (!sorted) {
      const Vec3 at = (x[i] - box.lower) * scale;
      const auto whole = [](double c) { return static_cast<std::uint32_t>(c); };
      key = morton_code(whole(at.x), whole(at.y), whole(at.z));
    }
    order.push_back((key << 32) | i);
  }
  if (!sorted) std::sort(order.begin(), order.end());
}

}  // namespace sansmesh::inline v1::detail
