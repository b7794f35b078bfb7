#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/volume/cells/box_tree.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway requires.
#include <hwy/highway.h>

#include "sansmesh/search/box_node-inl.h"
#include "sansmesh/volume/cells/box_tree.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {

void AppendOverlapping(const BoxLevels& levels, const std::vector<std::uint32_t>& order, const Box3f& box,
                       std::vector<std::uint32_t>& out) {
  ForEachOverlapping(levels, levels.size() - 1, 0, box, [&](std::size_t slot) HWY_ATTR {
    out.push_back(order[slot]);
    return true;
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace detail {
HWY_EXPORT(AppendOverlapping);

static void append_overlapping(const BoxLevels& levels, const std::vector<std::uint32_t>& order, const Box3f& box,
                               std::vector<std::uint32_t>& out) {
  HWY_DYNAMIC_DISPATCH(AppendOverlapping)(levels, order, box, out);
}
}  // namespace detail

namespace {

struct TreeItem {
  Vec3f center;
  std::uint32_t index;
};

Box3f outward(const Box3& box, const Vec3& origin, double scale) {
  return rounded_outward({(box.lower - origin) * scale, (box.upper - origin) * scale});
}

/// Orders items so that runs of `chunk`, the future children of nodes, are compact, recursively within each run.
void order_items(std::span<TreeItem> items, std::size_t chunk) {
  while (chunk > 1 && items.size() <= chunk) chunk /= kTreeWidth;
  if (items.size() <= 1) return;
  Box3f box;
  for (const TreeItem& item : items) box.extend(item.center);
  const Vec3f size = box.size();
  const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t chunks = (items.size() + chunk - 1) / chunk, middle = (chunks / 2) * chunk;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
                   [axis](const TreeItem& a, const TreeItem& b) {
                     return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.index < b.index;
                   });
  const auto left = [&] { order_items(items.first(middle), chunk); };
  const auto right = [&] { order_items(items.subspan(middle), chunk); };
  if (items.size() > 16384)
    parallel_invoke(left, right);
  else
    left(), right();
}

}  // namespace

BoxTree::BoxTree(std::size_t count, const std::function<Box3(std::size_t)>& box) {
  const auto usable = [](const Box3& b) { return !b.empty() && is_finite(b.lower) && is_finite(b.upper); };
  const Box3 whole = parallel_reduce(
      count, 65536, Box3{},
      [&](std::size_t first, std::size_t last) {
        Box3 part;
        for (std::size_t i = first; i < last; ++i)
          if (const Box3 b = box(i); usable(b)) part.extend(b);
        return part;
      },
      [](Box3 a, const Box3& b) {
        a.extend(b);
        return a;
      });
  if (whole.empty()) return;
  origin_ = whole.lower * 0.5 + whole.upper * 0.5;
  const Vec3 half = whole.upper * 0.5 - whole.lower * 0.5;
  const double largest = std::max({half.x, half.y, half.z});
  scale_ = largest > 0 ? std::ldexp(1.0, -std::clamp(std::ilogb(largest), -1000, 1000)) : 1;

  std::vector<TreeItem> items(count);
  parallel_for(0, count, 8192, [&](std::size_t i) {
    const Box3 b = box(i);
    items[i].index = static_cast<std::uint32_t>(i);
    items[i].center = usable(b) ? Vec3f((b.lower * 0.5 + b.upper * 0.5 - origin_) * scale_)
                                : Vec3f{std::numeric_limits<float>::infinity(), 0, 0};
  });
  std::erase_if(items, [](const TreeItem& item) { return !std::isfinite(item.center.x); });
  std::size_t chunk = 1;
  while (chunk * kTreeWidth < items.size()) chunk *= kTreeWidth;
  order_items(items, chunk);
  order_.resize(items.size());
  std::vector<Box3f> boxes(items.size());
  parallel_for(0, items.size(), 8192, [&](std::size_t i) {
    order_[i] = items[i].index;
    boxes[i] = outward(box(items[i].index), origin_, scale_);
  });
  items = {};
  levels_ = box_levels(std::move(boxes));
}

void BoxTree::overlapping(const Box3& box, std::vector<std::uint32_t>& items) const {
  items.clear();
  if (!levels_.empty()) detail::append_overlapping(levels_, order_, outward(box, origin_, scale_), items);
}

void BoxTree::child_distances(const BoxNode& node, const Vec3& q, double* distances) const {
  const double unit = 1 / (scale_ * scale_);
  for (std::size_t c = 0; c < kTreeWidth; ++c) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double d =
          std::max({static_cast<double>(node.lower[k][c]) - q[k], q[k] - static_cast<double>(node.upper[k][c]), 0.0});
      sum += d * d;
    }
    distances[c] = sum * unit;
  }
}

}  // namespace sansmesh::inline v1
#endif
