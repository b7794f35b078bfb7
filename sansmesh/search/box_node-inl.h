// Tests of eight boxes against a point or a box, the first step of all tree queries. Included once per instruction set.
#if defined(SANSMESH_SEARCH_BOX_NODE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SANSMESH_SEARCH_BOX_NODE_INL_H_
#undef SANSMESH_SEARCH_BOX_NODE_INL_H_
#else
#define SANSMESH_SEARCH_BOX_NODE_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>
#include <cstdint>

#include "sansmesh/search/box_levels.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, kTreeWidth>;
using V = hn::Vec<Tag>;
constexpr std::size_t kLanes = hn::MaxLanes(Tag());

/// Bit set of the lanes in `mask`; the first lane is child `at`.
HWY_INLINE std::uint32_t Bits(const hn::Mask<Tag>& mask, std::size_t at) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Tag(), mask, bits);
  return static_cast<std::uint32_t>(bits[0] & ((1u << kLanes) - 1)) << at;
}

/// Distances of numbers from intervals; 0 inside.
HWY_INLINE V Gap(const V& lower, const V& upper, const V& from, const V& to) {
  return hn::Max(hn::Max(hn::Sub(lower, to), hn::Sub(from, upper)), hn::Zero(Tag()));
}

/// x² + y² + z² with the operations of squared_distance: no fused multiply-add, so that results are bit-identical.
HWY_INLINE V SquaredLength(const V& x, const V& y, const V& z) {
  return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
}

/// Children whose boxes overlap `box`.
HWY_INLINE std::uint32_t Overlapping(const BoxNode& node, const Box3f& box) {
  const Tag d;
  std::uint32_t hits = 0;
  for (std::size_t i = 0; i < kTreeWidth; i += kLanes) {
    const auto axis = [&](int k, float lower, float upper) HWY_ATTR {
      return hn::And(hn::Le(hn::LoadU(d, node.lower[k] + i), hn::Set(d, upper)),
                     hn::Ge(hn::LoadU(d, node.upper[k] + i), hn::Set(d, lower)));
    };
    const auto x = axis(0, box.lower.x, box.upper.x), y = axis(1, box.lower.y, box.upper.y);
    hits |= Bits(hn::And(hn::And(x, y), axis(2, box.lower.z, box.upper.z)), i);
  }
  return hits;
}

/// Children whose boxes are within the root of `limit` of q; writes the squared distances of all children.
HWY_INLINE std::uint32_t Within(const BoxNode& node, const Vec3f& q, float limit, float* HWY_RESTRICT distances) {
  const Tag d;
  const V worst = hn::Set(d, limit), x = hn::Set(d, q.x), y = hn::Set(d, q.y), z = hn::Set(d, q.z);
  std::uint32_t hits = 0;
  for (std::size_t i = 0; i < kTreeWidth; i += kLanes) {
    const auto gap = [&](int k, const V& c) HWY_ATTR {
      return Gap(hn::LoadU(d, node.lower[k] + i), hn::LoadU(d, node.upper[k] + i), c, c);
    };
    const V d2 = SquaredLength(gap(0, x), gap(1, y), gap(2, z));
    hn::StoreU(d2, d, distances + i);
    hits |= Bits(hn::Le(d2, worst), i);
  }
  return hits;
}

/// Calls leaf(item) in ascending order for the items below a node whose boxes overlap `box`, until it returns false.
/// Returns whether it never did.
template <class Leaf>
bool ForEachOverlapping(const BoxLevels& levels, std::size_t level, std::size_t node, const Box3f& box,
                        const Leaf& leaf) {
  for (std::uint32_t hits = Overlapping(levels[level][node], box); hits; hits &= hits - 1) {
    const std::size_t child = node * kTreeWidth + static_cast<std::size_t>(std::countr_zero(hits));
    if (!(level > 0 ? ForEachOverlapping(levels, level - 1, child, box, leaf) : leaf(child))) return false;
  }
  return true;
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#endif
