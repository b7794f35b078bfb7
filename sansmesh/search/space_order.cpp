#include "sansmesh/search/space_order.h"

#include <algorithm>

#include "sansmesh/box.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kLastCell = (1u << 21) - 1;

}  // namespace

std::vector<std::uint32_t> space_order(std::span<const Vec3> x, const Vec3& lower, double scale) {
  std::vector<KeyIndex> keys(x.size());
  parallel_for(0, keys.size(), 8192, [&](std::size_t i) {
    const Vec3 at = (x[i] - lower) * scale;
    const auto cell = [](double c) { return index_in<std::uint32_t>(c, 0, kLastCell); };
    keys[i] = {morton_code(cell(at.x), cell(at.y), cell(at.z)), static_cast<unsigned>(i)};
  });
  parallel_sort(keys);
  std::vector<std::uint32_t> order(x.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = keys[i].index;
  return order;
}

std::vector<std::uint32_t> space_order(std::span<const Vec3> x) {
  Box3 box;
  for (const Vec3& p : x) box.extend(p);
  const Vec3 size = x.empty() ? Vec3{} : box.size();
  const double longest = std::max({size.x, size.y, size.z});
  return space_order(x, box.lower, longest > 0 ? kLastCell / longest : 0);
}

}  // namespace sansmesh::inline v1
