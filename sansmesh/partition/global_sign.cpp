#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/partition/global_sign.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "sansmesh/core/box.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/global_sign.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Dipole sum Σ ⟨p − x, a⟩ / r³ and Σ area / r⁶ over the tree. A group counts as one where it is farther than √2 times
/// its radius.
void SumSources(const std::vector<std::vector<GlobalSign::Octet>>& levels, const Vec3f& p, float* dipole,
                float* nearness) {
  const hn::CappedTag<float, 8> d;
  const std::size_t lanes = hn::Lanes(d);
  struct Item {
    std::uint32_t level, octet;
  };
  Item stack[256];
  std::size_t top = 0;
  stack[top++] = {static_cast<std::uint32_t>(levels.size() - 1), 0};
  auto sum = hn::Zero(d), near = hn::Zero(d);
  const auto px = hn::Set(d, p.x), py = hn::Set(d, p.y), pz = hn::Set(d, p.z);
  while (top > 0) {
    const Item item = stack[--top];
    const GlobalSign::Octet& o = levels[item.level][item.octet];
    for (std::size_t i = 0; i < 8; i += lanes) {
      const auto dx = hn::Sub(hn::LoadU(d, o.x + i), px), dy = hn::Sub(hn::LoadU(d, o.y + i), py),
                 dz = hn::Sub(hn::LoadU(d, o.z + i), pz);
      const auto area = hn::LoadU(d, o.area + i), radius = hn::LoadU(d, o.radius + i);
      auto r2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
      auto count = hn::Ge(radius, hn::Zero(d));
      if (item.level > 0) {
        const auto far = hn::Gt(r2, hn::Mul(hn::Set(d, 2.0f), hn::Mul(radius, radius)));
        const auto open = hn::AndNot(far, count);
        if (!hn::AllFalse(d, open)) {
          std::uint8_t bits[8] = {};
          hn::StoreMaskBits(d, open, bits);
          for (unsigned b = bits[0]; b != 0; b &= b - 1)
            stack[top++] = {item.level - 1, item.octet * 8 + static_cast<std::uint32_t>(i) +
                                                static_cast<std::uint32_t>(std::countr_zero(b))};
        }
        count = hn::And(count, far);
      } else {
        // A patch is a disc, not a point: soften within its radius.
        r2 = hn::MulAdd(area, hn::Set(d, 0.25f), r2);
      }
      r2 = hn::IfThenElse(count, hn::Max(r2, hn::Set(d, 1e-12f)), hn::Set(d, 1.0f));
      const auto dot = hn::MulAdd(dx, hn::LoadU(d, o.ax + i),
                                  hn::MulAdd(dy, hn::LoadU(d, o.ay + i), hn::Mul(dz, hn::LoadU(d, o.az + i))));
      // One Newton step makes the quick reciprocal root good to about 22 bits.
      auto root = hn::ApproximateReciprocalSqrt(r2);
      root = hn::Mul(root, hn::NegMulAdd(hn::Mul(hn::Set(d, 0.5f), r2), hn::Mul(root, root), hn::Set(d, 1.5f)));
      const auto cube = hn::Mul(root, hn::Mul(root, root));
      sum = hn::Add(sum, hn::IfThenElseZero(count, hn::Mul(dot, cube)));
      near = hn::Add(near, hn::IfThenElseZero(count, hn::Mul(area, hn::Mul(cube, cube))));
    }
  }
  *dipole = hn::GetLane(hn::SumOfLanes(d, sum));
  *nearness = hn::GetLane(hn::SumOfLanes(d, near));
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh {
HWY_EXPORT(SumSources);

float plane_area_in_cube(const Vec3f& point, const Vec3f& normal, const Vec3f& lower, float edge) {
  // A square of the plane that is larger than the cube, cut by the cube's six sides.
  Vec3f t, b;
  tangent_frame(normal, t, b);
  const Vec3f middle = lower + Vec3f{edge, edge, edge} * 0.5f;
  const Vec3f foot = middle - normal * dot(middle - point, normal);
  const float size = 1.8f * edge;
  std::array<Vec3f, 12> polygon{foot - t * size - b * size, foot + t * size - b * size, foot + t * size + b * size,
                                foot - t * size + b * size};
  std::size_t n = 4;
  std::array<Vec3f, 12> cut;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const float plane = side < 0 ? lower[axis] : lower[axis] + edge;
      std::size_t m = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const Vec3f &p = polygon[i], &q = polygon[(i + 1) % n];
        const float dp = side * (plane - p[axis]), dq = side * (plane - q[axis]);
        if (dp >= 0) cut[m++] = p;
        if ((dp >= 0) != (dq >= 0)) cut[m++] = p + (q - p) * (dp / (dp - dq));
      }
      n = m;
      polygon = cut;
      if (n == 0) return 0;
    }
  Vec3f sum;
  for (std::size_t i = 1; i + 1 < n; ++i) sum += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  return 0.5f * norm(sum);
}

GlobalSign::GlobalSign(std::span<const OrientedPatch> patches, float unit) : unit_(unit) {
  struct Item {
    Vec3f position, area;
    float weight = 0, radius = -1;
    Box3f box;
  };
  std::vector<Item> items;
  for (const OrientedPatch& p : patches) {
    const Vec3f position = p.position / unit, area = p.area / unit / unit;
    const float a = norm(area);
    if (!(a > 0) || !is_finite(position)) continue;
    items.push_back({position, area, a, std::sqrt(a / std::numbers::pi_v<float>), {position, position}});
  }
  if (items.empty()) return;
  for (;;) {
    std::vector<Octet> octets((items.size() + 7) / 8);
    std::vector<Item> above(octets.size());
    parallel_for(0, octets.size(), 1024, [&](std::size_t o) {
      Octet& octet = octets[o];
      Item& group = above[o];
      Vec3f mean;
      for (std::size_t k = 0; k < 8; ++k) {
        const std::size_t i = 8 * o + k;
        const Item item = i < items.size() ? items[i] : Item{};
        octet.x[k] = item.position.x, octet.y[k] = item.position.y, octet.z[k] = item.position.z;
        octet.ax[k] = item.area.x, octet.ay[k] = item.area.y, octet.az[k] = item.area.z;
        octet.area[k] = item.weight, octet.radius[k] = item.radius;
        mean += item.position * item.weight;
        group.area += item.area;
        group.weight += item.weight;
      }
      group.position = mean / group.weight;
      for (std::size_t i = 8 * o; i < std::min(items.size(), 8 * o + 8); ++i) group.box.extend(items[i].box);
      for (unsigned corner = 0; corner < 8; ++corner) {
        const Vec3f at{corner & 1 ? group.box.lower.x : group.box.upper.x,
                       corner & 2 ? group.box.lower.y : group.box.upper.y,
                       corner & 4 ? group.box.lower.z : group.box.upper.z};
        group.radius = std::max(group.radius, norm(at - group.position));
      }
    });
    levels_.push_back(std::move(octets));
    if (above.size() == 1) break;
    items = std::move(above);
  }
}

namespace {

/// So many units away the sums of 1/r⁶ come near the smallest floats.
constexpr double kFar = 1e5;

/// The place in the same direction that is at most kFar away. `ratio`: how much farther x is.
Vec3f pulled_in(const Vec3f& x, float& ratio) {
  ratio = 1;
  const auto limited = [](float v) { return std::clamp(static_cast<double>(v), -1e25, 1e25); };
  const Vec3 p{limited(x.x), limited(x.y), limited(x.z)};
  const double distance = norm(p);
  if (!(distance > kFar)) return x;
  ratio = static_cast<float>(distance / kFar);
  return Vec3f(p * (kFar / distance));
}

}  // namespace

void GlobalSign::winding_number(std::span<const Vec3f> x, std::span<float> values) const {
  for (std::size_t i = 0; i < x.size(); ++i) {
    float dipole = 0, nearness = 0, ratio = 1;
    const Vec3f p = pulled_in(x[i] / unit_, ratio);
    if (!empty()) HWY_DYNAMIC_DISPATCH(SumSources)(levels_, p, &dipole, &nearness);
    values[i] = dipole / (4 * std::numbers::pi_v<float>);
  }
}

void GlobalSign::signed_distance(std::span<const Vec3f> x, std::span<float> values) const {
  for (std::size_t i = 0; i < x.size(); ++i) {
    float dipole = 0, nearness = 0, ratio = 1;
    const Vec3f p = pulled_in(x[i] / unit_, ratio);
    if (!empty()) HWY_DYNAMIC_DISPATCH(SumSources)(levels_, p, &dipole, &nearness);
    // ∫ dA / r⁶ over a plane at distance d is π / (2 d⁴). Far from everything that grows with r^{3/2}.
    const float distance = nearness > 0 ? std::sqrt(std::sqrt(0.5f * std::numbers::pi_v<float> / nearness)) : 0;
    const float far = ratio > 1 ? ratio * std::sqrt(ratio) : 1;
    values[i] =
        std::clamp(1 - dipole / (2 * std::numbers::pi_v<float>), -1.0f, 1.0f) * std::min(distance * far * unit_, 1e37f);
  }
}

}  // namespace sansmesh
#endif
