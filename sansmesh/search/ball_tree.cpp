// Compiled once for each instruction set: sizeless vectors cannot stand in arrays, hence not for these.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/search/ball_tree.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway requires.
#include <hwy/highway.h>

#include <bit>

#include "sansmesh/search/ball_tree.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kBalls = BallTree::kWidth;
using Tag = hn::CappedTag<float, kBalls>;
using V = hn::Vec<Tag>;
constexpr std::size_t kLanes = hn::MaxLanes(Tag());

HWY_INLINE std::uint32_t Bits(const hn::Mask<Tag>& mask, std::size_t at) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Tag(), mask, bits);
  return static_cast<std::uint32_t>(bits[0] & ((1u << kLanes) - 1)) << at;
}

HWY_INLINE std::uint32_t Overlapping(const BallTree::Node& node, const Box3f& box) {
  const Tag d;
  std::uint32_t hits = 0;
  for (std::size_t i = 0; i < kBalls; i += kLanes) {
    const auto axis = [&](int k, float lower, float upper) {
      return hn::And(hn::Le(hn::LoadU(d, node.lower[k] + i), hn::Set(d, upper)),
                     hn::Ge(hn::LoadU(d, node.upper[k] + i), hn::Set(d, lower)));
    };
    const auto x = axis(0, box.lower.x, box.upper.x), y = axis(1, box.lower.y, box.upper.y);
    hits |= Bits(hn::And(hn::And(x, y), axis(2, box.lower.z, box.upper.z)), i);
  }
  return hits;
}

HWY_INLINE std::uint32_t Touching(const BallTree::Leaf& leaf, const Box3f& box) {
  const Tag d;
  const V zero = hn::Zero(d);
  std::uint32_t hits = 0;
  for (std::size_t i = 0; i < kBalls; i += kLanes) {
    const auto gap = [&](const float* c, float lower, float upper) {
      const V at = hn::LoadU(d, c + i);
      return hn::Max(hn::Max(hn::Sub(hn::Set(d, lower), at), hn::Sub(at, hn::Set(d, upper))), zero);
    };
    const V x = gap(leaf.x, box.lower.x, box.upper.x), y = gap(leaf.y, box.lower.y, box.upper.y);
    const V z = gap(leaf.z, box.lower.z, box.upper.z);
    const V r = hn::LoadU(d, leaf.radius + i);
    const V d2 = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
    hits |= Bits(hn::And(hn::Le(d2, hn::Mul(r, r)), hn::Ge(r, zero)), i);
  }
  return hits;
}

void Collect(const std::vector<BallTree::Leaf>& leaves, const std::vector<std::vector<BallTree::Node>>& levels,
             std::size_t level, std::size_t node, const Box3f& box, std::vector<std::uint32_t>& out) {
  for (std::uint32_t hits = Overlapping(levels[level][node], box); hits; hits &= hits - 1) {
    const std::size_t child = node * kBalls + static_cast<std::size_t>(std::countr_zero(hits));
    if (level > 0) {
      Collect(leaves, levels, level - 1, child, box, out);
      continue;
    }
    for (std::uint32_t balls = Touching(leaves[child], box); balls; balls &= balls - 1)
      out.push_back(static_cast<std::uint32_t>(child * kBalls + static_cast<std::size_t>(std::countr_zero(balls))));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <limits>

#include "sansmesh/core/error.h"

namespace sansmesh {
HWY_EXPORT(Collect);

BallTree::BallTree(std::span<const Vec3f> centers, std::span<const float> radii) : size_(centers.size()) {
  if (centers.size() != radii.size()) throw ArgumentError("BallTree: as many radii as centers are needed");
  if (size_ == 0) return;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Node none;
  for (int k = 0; k < 3; ++k)
    for (std::size_t c = 0; c < kWidth; ++c) none.lower[k][c] = kInfinity, none.upper[k][c] = -kInfinity;

  const std::size_t leaf_count = (size_ + kWidth - 1) / kWidth;
  leaves_.resize(leaf_count);
  levels_.emplace_back((leaf_count + kWidth - 1) / kWidth, none);
  for (std::size_t l = 0; l < leaf_count; ++l) {
    Node& node = levels_[0][l / kWidth];
    for (std::size_t c = 0; c < kWidth; ++c) {
      const std::size_t i = l * kWidth + c;
      const bool used = i < size_;
      leaves_[l].radius[c] = used ? radii[i] : -1;
      const Vec3f p = used ? centers[i] : Vec3f{};
      leaves_[l].x[c] = p.x, leaves_[l].y[c] = p.y, leaves_[l].z[c] = p.z;
      if (!used) continue;
      // Rounded outward: no ball may stick out of its box.
      const float r = radii[i] * (1 + 1e-6f);
      for (std::size_t k = 0; k < 3; ++k) {
        const float slack = r + 1e-6f * std::abs(p[k]);
        node.lower[k][l % kWidth] = std::min(node.lower[k][l % kWidth], p[k] - slack);
        node.upper[k][l % kWidth] = std::max(node.upper[k][l % kWidth], p[k] + slack);
      }
    }
  }
  while (levels_.back().size() > 1) {
    const std::vector<Node>& below = levels_.back();
    std::vector<Node> nodes((below.size() + kWidth - 1) / kWidth, none);
    for (std::size_t b = 0; b < below.size(); ++b)
      for (int k = 0; k < 3; ++k) {
        nodes[b / kWidth].lower[k][b % kWidth] = *std::min_element(below[b].lower[k], below[b].lower[k] + kWidth);
        nodes[b / kWidth].upper[k][b % kWidth] = *std::max_element(below[b].upper[k], below[b].upper[k] + kWidth);
      }
    levels_.push_back(std::move(nodes));
  }
}

void BallTree::touching(const Box3f& box, std::vector<std::uint32_t>& out) const {
  out.clear();
  if (size_ > 0) HWY_DYNAMIC_DISPATCH(Collect)(leaves_, levels_, levels_.size() - 1, 0, box, out);
}

}  // namespace sansmesh
#endif
