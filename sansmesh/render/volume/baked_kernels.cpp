#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/render/volume/baked_kernels.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway requires.
#include <hwy/highway.h>

#include <algorithm>

#include "sansmesh/render/volume/baked_kernels.h"

#ifndef SANSMESH_RENDER_BRICK_PLACE
#define SANSMESH_RENDER_BRICK_PLACE
namespace sansmesh::inline v1::detail {

/// Each level of the descent doubles the coordinates, which is exact.
inline BrickPoint point_in_bricks(const BrickTree& tree, const Vec3& x) {
  double f[3];
  std::int32_t root = 0;
  for (int k = 2; k >= 0; --k) {
    const auto axis = static_cast<std::size_t>(k);
    const double most = tree.counts[k];
    double at = (x[axis] - tree.lower[axis]) * tree.inverse[axis];
    at = at > 0 ? (at < most ? at : most) : 0;
    int whole = static_cast<int>(at);
    if (whole == tree.counts[k]) --whole;
    f[k] = at - whole;
    root = root * tree.counts[k] + whole;
  }
  std::int32_t branch = tree.branches[root];
  while (branch >= 0) {
    std::int32_t child = 0;
    for (int k = 0; k < 3; ++k) {
      const double twice = 2 * f[k];
      const std::int32_t half = twice >= 1 ? 1 : 0;
      f[k] = twice - half;
      child |= half << k;
    }
    branch = tree.branches[branch + child];
  }
  return {~branch, static_cast<float>(f[0] * kBrickCells), static_cast<float>(f[1] * kBrickCells),
          static_cast<float>(f[2] * kBrickCells)};
}

}  // namespace sansmesh::inline v1::detail
#endif

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Four lanes (or fewer in sequence): a value and its gradient, which share the interpolation between the nodes of a
/// cell.
using BrickTag = hn::CappedTag<float, 4>;
constexpr std::size_t kBrickLanes = hn::MaxLanes(BrickTag());

HWY_INLINE void BetweenNodes(const BrickTree& tree, const BrickPoint& p, float* HWY_RESTRICT found) {
  const BrickTag tag;
  const auto cell = [](float at) {
    const int i = static_cast<int>(at);
    return i < kBrickCells ? i : kBrickCells - 1;
  };
  const int i = cell(p.x), j = cell(p.y), k = cell(p.z);
  constexpr std::size_t kRow = 4u * kBrickNodes, kLayer = kRow * kBrickNodes;
  const auto tx = hn::Set(tag, p.x - static_cast<float>(i)), ty = hn::Set(tag, p.y - static_cast<float>(j));
  const auto tz = hn::Set(tag, p.z - static_cast<float>(k));
  // Rounded twice on every machine: emulation of a fused multiply-add would be slow.
  const auto between = [](auto a, auto b, auto t) HWY_ATTR { return hn::Add(a, hn::Mul(hn::Sub(b, a), t)); };
  const auto along_x = [&](const float* from)
                           HWY_ATTR { return between(hn::LoadU(tag, from), hn::LoadU(tag, from + 4), tx); };
  for (std::size_t lane = 0; lane < 4; lane += kBrickLanes) {
    const float* at = tree.nodes + static_cast<std::size_t>(p.brick) * kBrickSize +
                      4 * static_cast<std::size_t>(i + kBrickNodes * (j + kBrickNodes * k)) + lane;
    const auto low = between(along_x(at), along_x(at + kRow), ty);
    const auto high = between(along_x(at + kLayer), along_x(at + kLayer + kRow), ty);
    hn::StoreU(between(low, high, tz), tag, found + lane);
  }
}

/// Prefetches the nodes of a cell: bricks exceed the cache by far, and rays visit them in irregular order.
HWY_INLINE void FetchNodes(const BrickTree& tree, const BrickPoint& p) {
  const auto cell = [](float at) { return std::min(static_cast<int>(at), kBrickCells - 1); };
  const float* const at = tree.nodes + static_cast<std::size_t>(p.brick) * kBrickSize +
                          4 * static_cast<std::size_t>(cell(p.x) + kBrickNodes * (cell(p.y) + kBrickNodes * cell(p.z)));
  constexpr std::size_t kRow = 4u * kBrickNodes, kLayer = kRow * kBrickNodes;
  for (const std::size_t row : {std::size_t{0}, kRow, kLayer, kLayer + kRow}) hwy::Prefetch(at + row);
}

void BrickValues(const BrickTree& tree, std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) {
  constexpr std::size_t kTogether = 16;
  BrickPoint located[kTogether];
  float found[4];
  for (std::size_t first = 0; first < x.size(); first += kTogether) {
    const std::size_t n = std::min(kTogether, x.size() - first);
    for (std::size_t k = 0; k < n; ++k) FetchNodes(tree, located[k] = point_in_bricks(tree, x[first + k]));
    for (std::size_t k = 0; k < n; ++k) {
      BetweenNodes(tree, located[k], found);
      const std::size_t i = first + k;
      if (!values.empty()) values[i] = static_cast<double>(found[0]);
      if (!gradients.empty()) gradients[i] = Vec3(Vec3f{found[1], found[2], found[3]});
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(BrickValues);

BrickPoint brick_point(const BrickTree& tree, const Vec3& x) { return point_in_bricks(tree, x); }

void brick_values(const BrickTree& tree, std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) {
  HWY_DYNAMIC_DISPATCH(BrickValues)(tree, x, values, gradients);
}

}  // namespace sansmesh::inline v1::detail
#endif
