#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/search/ball_tree.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h (Highway).
#include <hwy/highway.h>

#include "sansmesh/search/ball_tree.h"
#include "sansmesh/search/box_node-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {

HWY_INLINE std::uint32_t Touching(const BallTree::Leaf& leaf, const Box3f& box) {
  const Tag d;
  std::uint32_t hits = 0;
  for (std::size_t i = 0; i < kTreeWidth; i += kLanes) {
    const auto gap = [&](const float* c, float lower, float upper) HWY_ATTR {
      const V at = hn::LoadU(d, c + i);
      return Gap(hn::Set(d, lower), hn::Set(d, upper), at, at);
    };
    const V x = gap(leaf.x, box.lower.x, box.upper.x), y = gap(leaf.y, box.lower.y, box.upper.y);
    const V z = gap(leaf.z, box.lower.z, box.upper.z);
    const V r = hn::LoadU(d, leaf.radius + i);
    hits |= Bits(hn::And(hn::Le(SquaredLength(x, y, z), hn::Mul(r, r)), hn::Ge(r, hn::Zero(d))), i);
  }
  return hits;
}

bool AppendTouching(const std::vector<BallTree::Leaf>& leaves, const BoxLevels& levels, const Box3f& box,
                    std::size_t most, std::vector<std::uint32_t>& out) {
  return ForEachOverlapping(levels, levels.size() - 1, 0, box, [&](std::size_t leaf) HWY_ATTR {
    for (std::uint32_t balls = Touching(leaves[leaf], box); balls; balls &= balls - 1) {
      if (out.size() == most) return false;
      out.push_back(static_cast<std::uint32_t>(leaf * kTreeWidth + static_cast<std::size_t>(std::countr_zero(balls))));
    }
    return true;
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <limits>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace detail {
HWY_EXPORT(AppendTouching);

static bool append_touching(const std::vector<BallTree::Leaf>& leaves, const BoxLevels& levels, const Box3f& box,
                            std::size_t most, std::vector<std::uint32_t>& out) {
  return HWY_DYNAMIC_DISPATCH(AppendTouching)(leaves, levels, box, most, out);
}
}  // namespace detail

BallTree::BallTree(std::span<const Vec3f> centers, std::span<const float> radii) : size_(centers.size()) {
  if (centers.size() != radii.size()) throw ArgumentError("BallTree: as many radii as centers are needed");
  leaves_.resize((size_ + kTreeWidth - 1) / kTreeWidth);
  std::vector<Box3f> boxes(leaves_.size());
  parallel_for(0, leaves_.size(), 1024, [&](std::size_t l) {
    for (std::size_t c = 0; c < kTreeWidth; ++c) {
      const std::size_t i = l * kTreeWidth + c;
      const bool used = i < size_;
      leaves_[l].radius[c] = used ? radii[i] : -1;
      const Vec3f p = used ? centers[i] : Vec3f{};
      leaves_[l].x[c] = p.x, leaves_[l].y[c] = p.y, leaves_[l].z[c] = p.z;
      if (!used) continue;
      // Rounds outward: no ball may extend beyond its box.
      const float r = radii[i] * (1 + 1e-6f);
      for (std::size_t k = 0; k < 3; ++k) {
        const float slack = r + 1e-6f * std::abs(p[k]);
        boxes[l].lower[k] = std::min(boxes[l].lower[k], p[k] - slack);
        boxes[l].upper[k] = std::max(boxes[l].upper[k], p[k] + slack);
      }
    }
  });
  levels_ = box_levels(std::move(boxes));
}

void BallTree::touching(const Box3f& box, std::vector<std::uint32_t>& out) const {
  touching(box, std::numeric_limits<std::size_t>::max(), out);
}

bool BallTree::touching(const Box3f& box, std::size_t most, std::vector<std::uint32_t>& out) const {
  out.clear();
  return size_ == 0 || detail::append_touching(leaves_, levels_, box, most, out);
}

}  // namespace sansmesh::inline v1
#endif
