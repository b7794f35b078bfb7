#include "sansmesh/volume/grid/point_order.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/box.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint64_t kNowhere = ~std::uint64_t{0};  ///< code of non-finite points; no other point has it

Box3 finite_box(std::span<const Vec3> points) {
  Box3 box;
  for (const Vec3& p : points)
    if (is_finite(p)) box.extend(p);
  return box;
}

/// The points sorted by their codes along the curve of the box, then by index.
std::vector<KeyIndex> along_curve(std::span<const Vec3> points, const Box3& box) {
  const double kMost = 2097151;  // 21 bits
  const Vec3 size = box.size();
  const double scale = kMost / std::max({size.x, size.y, size.z, std::numeric_limits<double>::min()});
  std::vector<KeyIndex> keys(points.size());
  parallel_for(0, points.size(), 8192, [&](std::size_t i) {
    keys[i] = {kNowhere, static_cast<unsigned>(i)};
    if (!is_finite(points[i])) return;
    const Vec3 q = (points[i] - box.lower) * scale;
    const auto cell = [kMost](double v) { return v > 0 ? static_cast<std::uint32_t>(std::min(v, kMost)) : 0u; };
    keys[i].key = morton_code(cell(q.x), cell(q.y), cell(q.z));
  });
  parallel_sort(keys);
  return keys;
}

std::vector<std::uint32_t> indices_of(const std::vector<KeyIndex>& keys) {
  std::vector<std::uint32_t> order(keys.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = keys[i].index;
  return order;
}

}  // namespace

std::vector<std::uint32_t> locality_order(std::span<const Vec3> points) {
  constexpr std::size_t kFew = 2048;
  if (points.size() < kFew) return {};
  const Box3 box = finite_box(points);
  const double diagonal = box.diagonal();
  if (!(diagonal > 0) || !std::isfinite(diagonal)) return {};
  // Estimated from the steps between some points: random ones are half a box apart.
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 1; i < points.size(); i += 1 + points.size() / 1024) {
    const double step = norm(points[i] - points[i - 1]);
    if (std::isfinite(step)) sum += step, ++count;
  }
  if (count == 0 || sum < 0.05 * diagonal * static_cast<double>(count)) return {};
  return indices_of(along_curve(points, box));
}

std::vector<std::uint32_t> canonical_point_order(std::span<const Vec3> points,
                                                 const std::function<bool(std::uint32_t, std::uint32_t)>& before) {
  std::vector<KeyIndex> keys = along_curve(points, finite_box(points));
  for (std::size_t first = 0, last; first < keys.size() && keys[first].key != kNowhere; first = last) {
    for (last = first + 1; last < keys.size() && keys[last].key == keys[first].key;) ++last;
    if (last - first < 2) continue;
    std::sort(keys.begin() + static_cast<std::ptrdiff_t>(first), keys.begin() + static_cast<std::ptrdiff_t>(last),
              [&](const KeyIndex& a, const KeyIndex& b) {
                const Vec3 &x = points[a.index], &y = points[b.index];
                if (x != y) return lexicographic_less(x, y);
                if (before(a.index, b.index)) return true;
                return !before(b.index, a.index) && a.index < b.index;
              });
  }
  return indices_of(keys);
}

}  // namespace sansmesh::inline v1
