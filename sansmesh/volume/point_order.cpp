#include "sansmesh/volume/point_order.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/box.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh {

std::vector<std::uint32_t> locality_order(std::span<const Vec3> points) {
  constexpr std::size_t kFew = 2048;
  if (points.size() < kFew) return {};
  Box3 box;
  for (const Vec3& p : points)
    if (is_finite(p)) box.extend(p);
  const double diagonal = box.diagonal();
  if (!(diagonal > 0) || !std::isfinite(diagonal)) return {};
  // The steps of some points tell: random ones are half a box apart.
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 1; i < points.size(); i += 1 + points.size() / 1024) {
    const double step = norm(points[i] - points[i - 1]);
    if (std::isfinite(step)) sum += step, ++count;
  }
  if (count == 0 || sum < 0.05 * diagonal * static_cast<double>(count)) return {};
  const double kMost = 2097151;  // 21 bits
  const Vec3 size = box.size();
  const double scale = kMost / std::max({size.x, size.y, size.z});
  std::vector<KeyIndex> keys(points.size());
  parallel_for(0, points.size(), 8192, [&](std::size_t i) {
    keys[i] = {~std::uint64_t{0}, static_cast<unsigned>(i)};
    if (!is_finite(points[i])) return;
    const Vec3 q = (points[i] - box.lower) * scale;
    const auto cell = [kMost](double v) { return static_cast<std::uint32_t>(std::clamp(v, 0.0, kMost)); };
    keys[i].key = morton_code(cell(q.x), cell(q.y), cell(q.z));
  });
  parallel_sort(keys);
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = keys[i].index;
  return order;
}

}  // namespace sansmesh
