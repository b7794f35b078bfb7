#include "sansmesh/core/simd_targets.h"
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
#include "sansmesh/core/portable-inl.h"
#include "sansmesh/partition/global_sign.h"

#ifndef SANSMESH_GLOBAL_SIGN_ONCE
#define SANSMESH_GLOBAL_SIGN_ONCE
namespace sansmesh {
/// Points and the sums over all patches at each: of dipoles / r³ (of open ones / r⁶), of area / r⁴, of area / r⁶; and
/// the gradients of those.
struct FarBatch {
  static constexpr std::size_t kBatch = 16;
  alignas(64) float x[3][kBatch], sum[3][kBatch], slope[3][3][kBatch];
};
/// Squared distance from a group in squares of its radius: below the first its members count, beyond the second it
/// counts as one. Closer up a group's 1/r⁶ is so far from that of its members that the hand-over would be steep.
constexpr float kOpen = 2.2f, kClosed = 4.8f;
}  // namespace sansmesh
#endif

HWY_BEFORE_NAMESPACE();
namespace sansmesh {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace pn = portable::HWY_NAMESPACE;

/// Sums over all patches at up to kBatch points: Σ ⟨p − x, a⟩ / r³ (/ r⁶ if kSheets), Σ area / r⁴, Σ area / r⁶ (and
/// their gradients if kGradient). A group counts as one where it is farther than about twice its radius; around that it
/// hands over to its members smoothly, so that the sums do not jump. All points walk down the tree together, each with
/// its own share in every group, so that what is found at one does not depend on the others.
template <bool kGradient, bool kSheets>
void SumSourcesT(const std::vector<std::vector<GlobalSign::Octet>>& levels, FarBatch& batch, std::size_t first) {
  constexpr std::size_t kLanes = 16, kStack = 256;
  const hn::CappedTag<float, kLanes> d;
  using V = hn::Vec<decltype(d)>;
  struct Item {
    std::uint32_t level, octet;
  };
  Item stack[kStack];
  // Of each item on the stack: the points' shares in it and, if kGradient, the gradients of those.
  HWY_ALIGN float shares[kStack][kLanes];
  HWY_ALIGN float slopes[kGradient ? kStack : 1][3][kLanes];
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const V p[3] = {hn::LoadU(d, batch.x[0] + first), hn::LoadU(d, batch.x[1] + first), hn::LoadU(d, batch.x[2] + first)};
  V sum[3] = {zero, zero, zero};
  V slope[3][3] = {{zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
  std::size_t top = 1;
  stack[0] = {static_cast<std::uint32_t>(levels.size() - 1), 0};
  hn::Store(one, d, shares[0]);
  if (kGradient)
    for (float* lane : slopes[0]) hn::Store(zero, d, lane);
  while (top > 0) {
    const Item item = stack[--top];
    const GlobalSign::Octet& o = levels[item.level][item.octet];
    const V whole = hn::Load(d, shares[top]);
    V whole_slope[3] = {zero, zero, zero};
    if (kGradient)
      for (std::size_t a = 0; a < 3; ++a) whole_slope[a] = hn::Load(d, slopes[top][a]);
    for (std::uint32_t k = 0; k < 8; ++k) {
      if (o.radius[k] < 0) continue;
      const V step[3] = {hn::Sub(hn::Set(d, o.x[k]), p[0]), hn::Sub(hn::Set(d, o.y[k]), p[1]),
                         hn::Sub(hn::Set(d, o.z[k]), p[2])};
      V r2 = pn::MulAdd(step[0], step[0], pn::MulAdd(step[1], step[1], hn::Mul(step[2], step[2])));
      V share = whole, share_slope[3] = {whole_slope[0], whole_slope[1], whole_slope[2]};
      if (item.level > 0) {
        const float inverse = 1 / (std::max(o.radius[k] * o.radius[k], 1e-20f) * (kClosed - kOpen));
        const V t = pn::MulAdd(r2, hn::Set(d, inverse), hn::Set(d, -kOpen / (kClosed - kOpen)));
        const auto open = hn::And(hn::Lt(t, one), hn::Gt(whole, zero));
        if (!hn::AllFalse(d, open)) {
          // The group's own part grows from 0 to 1 with t; the rest is its members'.
          const V u = hn::Min(hn::Max(t, zero), one);
          const V part = hn::Mul(hn::Mul(u, u), pn::NegMulAdd(hn::Set(d, 2.0f), u, hn::Set(d, 3.0f)));
          share = hn::Mul(whole, part);
          stack[top] = {item.level - 1, item.octet * 8 + k};
          hn::Store(hn::Sub(whole, share), d, shares[top]);
          if (kGradient) {
            const V turn = hn::Mul(hn::Mul(whole, hn::Mul(u, hn::Sub(one, u))), hn::Set(d, -12 * inverse));
            for (std::size_t a = 0; a < 3; ++a) {
              share_slope[a] = pn::MulAdd(turn, step[a], hn::Mul(whole_slope[a], part));
              hn::Store(hn::Sub(whole_slope[a], share_slope[a]), d, slopes[top][a]);
            }
          }
          ++top;
          if (hn::AllTrue(d, hn::Le(share, zero))) continue;
        }
      } else {
        // A patch is a disc, not a point: soften within its radius.
        r2 = hn::Add(r2, hn::Set(d, 0.25f * o.area[k]));
      }
      r2 = hn::IfThenElse(hn::Gt(share, zero), hn::Max(r2, hn::Set(d, 1e-12f)), one);
      const V normal[3] = {hn::Set(d, o.ax[k]), hn::Set(d, o.ay[k]), hn::Set(d, o.az[k])};
      const V dot = pn::MulAdd(step[0], normal[0], pn::MulAdd(step[1], normal[1], hn::Mul(step[2], normal[2])));
      const V area = hn::Set(d, o.area[k]);
      const V root = pn::ReciprocalSqrt(r2);
      const V square = hn::Mul(root, root), cube = hn::Mul(root, square);
      const V sixth = hn::Mul(cube, cube), pull_of_dipole = kSheets ? sixth : cube;
      const V term[3] = {hn::Mul(dot, pull_of_dipole), hn::Mul(area, hn::Mul(square, square)), hn::Mul(area, sixth)};
      for (std::size_t m = 0; m < 3; ++m) sum[m] = pn::MulAdd(share, term[m], sum[m]);
      if (kGradient) {
        constexpr float kPower[3] = {kSheets ? 6 : 3, 4, 6};  // ∇ 1/rⁿ = n/rⁿ⁺² (p − x)
        for (std::size_t m = 0; m < 3; ++m) {
          const V pull = hn::Mul(hn::Mul(hn::Set(d, kPower[m]), hn::Mul(share, square)), term[m]);
          for (std::size_t a = 0; a < 3; ++a)
            slope[m][a] = pn::MulAdd(share_slope[a], term[m], pn::MulAdd(pull, step[a], slope[m][a]));
        }
        for (std::size_t a = 0; a < 3; ++a)
          slope[0][a] = pn::NegMulAdd(hn::Mul(share, pull_of_dipole), normal[a], slope[0][a]);
      }
    }
  }
  for (std::size_t m = 0; m < 3; ++m) hn::StoreU(sum[m], d, batch.sum[m] + first);
  if (kGradient)
    for (std::size_t m = 0; m < 3; ++m)
      for (std::size_t a = 0; a < 3; ++a) hn::StoreU(slope[m][a], d, batch.slope[m][a] + first);
}

void SumSources(const std::vector<std::vector<GlobalSign::Octet>>& levels, bool gradient, bool open, std::size_t count,
                FarBatch& batch) {
  const std::size_t lanes = hn::Lanes(hn::CappedTag<float, 16>());
  for (std::size_t i = 0; i < count; i += lanes) {
    if (gradient) {
      open ? SumSourcesT<true, true>(levels, batch, i) : SumSourcesT<true, false>(levels, batch, i);
    } else {
      open ? SumSourcesT<false, true>(levels, batch, i) : SumSourcesT<false, false>(levels, batch, i);
    }
  }
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

GlobalSign::GlobalSign(std::span<const OrientedPatch> patches, float unit, bool open) : unit_(unit), open_(open) {
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
    items.push_back({position,
                     area,
                     std::max(a, p.least / unit / unit),
                     std::sqrt(a / std::numbers::pi_v<float>),
                     {position, position}});
  }
  levels_ =
      eight_wide_levels<Octet>(std::move(items), [](std::span<const Item> siblings, std::size_t level, Octet& octet) {
        Item group;
        Vec3f mean;
        for (std::size_t k = 0; k < kTreeWidth; ++k) {
          const Item item = k < siblings.size() ? siblings[k] : Item{};
          octet.x[k] = item.position.x, octet.y[k] = item.position.y, octet.z[k] = item.position.z;
          octet.ax[k] = item.area.x, octet.ay[k] = item.area.y, octet.az[k] = item.area.z;
          octet.area[k] = item.weight, octet.radius[k] = item.radius;
          mean += item.position * item.weight;
          group.area += item.area;
          group.weight += item.weight;
        }
        group.position = mean / group.weight;
        for (const Item& item : siblings) group.box.extend(item.box);
        float far = 0;  // members' own extents count: two bounds, and the smaller one holds
        for (const Item& item : siblings)
          far = std::max(far, norm(item.position - group.position) + (level == 0 ? 0 : item.radius));
        for (unsigned corner = 0; corner < 8; ++corner) {
          const Vec3f at{corner & 1 ? group.box.lower.x : group.box.upper.x,
                         corner & 2 ? group.box.lower.y : group.box.upper.y,
                         corner & 4 ? group.box.lower.z : group.box.upper.z};
          group.radius = std::max(group.radius, norm(at - group.position));
        }
        group.radius = std::min(group.radius, far);
        return group;
      });
}

namespace {

/// From so many units away all patches are one point, and the sums of 1/r⁶ are still far from the smallest floats.
constexpr double kFar = 1000;

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

namespace {

/// The sums at some of the points, brought within kFar.
void sum_batch(const std::vector<std::vector<GlobalSign::Octet>>& levels, std::span<const Vec3f> x, float unit,
               bool gradient, bool open, float* ratio, FarBatch& batch) {
  for (std::size_t i = 0; i < FarBatch::kBatch; ++i) {
    const std::size_t k = std::min(i, x.size() - 1);
    const Vec3f p = pulled_in(x[k] / unit, ratio[k]);
    for (std::size_t a = 0; a < 3; ++a) batch.x[a][i] = p[a];
  }
  HWY_DYNAMIC_DISPATCH(SumSources)(levels, gradient, open, x.size(), batch);
}

}  // namespace

void GlobalSign::winding_number(std::span<const Vec3f> x, std::span<float> values) const {
  FarBatch batch;
  float ratio[FarBatch::kBatch];
  for (std::size_t first = 0; first < x.size(); first += FarBatch::kBatch) {
    const std::size_t n = std::min(FarBatch::kBatch, x.size() - first);
    if (!empty()) sum_batch(levels_, x.subspan(first, n), unit_, false, false, ratio, batch);
    for (std::size_t i = 0; i < n; ++i)
      values[first + i] = empty() ? 0 : batch.sum[0][i] / (4 * std::numbers::pi_v<float>);
  }
}

namespace {

/// Over a plane at distance d, ∫ dA / r⁴ is π / d² and ∫ dA / r⁶ is π / (2 d⁴): their ratio is the square of a mean
/// distance that grows no faster than r, however far away. `f.value` is a length; `in_units` the value at the place
/// that the sums belong to, `ratio` times nearer.
void closed_value(const FarBatch& batch, std::size_t i, bool gradient, float ratio, float unit, FarValue& f,
                  float& in_units) {
  const float dipole = batch.sum[0][i], fourth = batch.sum[1][i], sixth = batch.sum[2][i];
  const float distance = sixth > 0 ? std::sqrt(0.5f * fourth / sixth) : 0;
  const float inside = 1 - dipole / (2 * std::numbers::pi_v<float>), sign = std::clamp(inside, -1.0f, 1.0f);
  in_units = sign * distance;
  f.value = sign * std::min(distance * ratio * unit, 1e37f);
  if (!gradient || !(distance > 0)) return;
  for (std::size_t a = 0; a < 3; ++a) {
    f.gradient[a] = (batch.slope[1][a][i] / fourth - batch.slope[2][a][i] / sixth) * (0.5f * distance * sign);
    if (sign == inside) f.gradient[a] -= batch.slope[0][a][i] * (distance / (2 * std::numbers::pi_v<float>));
  }
}

void open_value(const FarBatch& batch, std::size_t i, bool gradient, float ratio, float unit, FarValue& f,
                float& in_units) {
  const float dipole = batch.sum[0][i], sixth = batch.sum[2][i];
  in_units = sixth > 0 ? -dipole / sixth : 0;
  f.value = std::clamp(in_units * ratio * unit, -1e37f, 1e37f);
  if (!gradient || !(sixth > 0)) return;
  for (std::size_t a = 0; a < 3; ++a) f.gradient[a] = -(batch.slope[0][a][i] + in_units * batch.slope[2][a][i]) / sixth;
}

}  // namespace

void GlobalSign::far_values(std::span<const Vec3f> x, bool gradient, std::span<FarValue> values) const {
  std::fill(values.begin(), values.end(), FarValue{});
  if (empty()) return;
  FarBatch batch;
  float ratio[FarBatch::kBatch];
  for (std::size_t first = 0; first < x.size(); first += FarBatch::kBatch) {
    const std::size_t n = std::min(FarBatch::kBatch, x.size() - first);
    sum_batch(levels_, x.subspan(first, n), unit_, gradient, open_, ratio, batch);
    for (std::size_t i = 0; i < n; ++i) {
      FarValue& f = values[first + i];
      float in_units = 0;
      (open_ ? open_value : closed_value)(batch, i, gradient, ratio[i], unit_, f, in_units);
      f.weight = batch.sum[2][i];
      if (!gradient) continue;
      for (std::size_t a = 0; a < 3; ++a) f.weight_gradient[a] = batch.slope[2][a][i] / unit_;
      if (ratio[i] > 1) {  // out there the values grow in proportion along the ray
        const Vec3f p{batch.x[0][i], batch.x[1][i], batch.x[2][i]}, ray = normalized(p);
        f.gradient += ray * (in_units / norm(p) - dot(ray, f.gradient));
      }
    }
  }
}

void GlobalSign::signed_distance(std::span<const Vec3f> x, std::span<float> values, std::span<Vec3f> gradients) const {
  std::vector<FarValue> far(x.size());
  far_values(x, !gradients.empty(), far);
  for (std::size_t i = 0; i < x.size(); ++i) {
    values[i] = far[i].value;
    if (!gradients.empty()) gradients[i] = far[i].gradient;
  }
}

void FarField::signed_distance(std::span<const Vec3f> x, std::span<float> values, std::span<Vec3f> gradients) const {
  if (open.empty()) return closed.signed_distance(x, values, gradients);
  if (closed.empty()) return open.signed_distance(x, values, gradients);
  const bool gradient = !gradients.empty();
  std::vector<FarValue> solid(x.size()), sheet(x.size());
  closed.far_values(x, gradient, solid);
  open.far_values(x, gradient, sheet);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const FarValue &a = solid[i], &b = sheet[i];
    const float sum = a.weight + b.weight, share = sum > 0 ? a.weight / sum : 1;
    values[i] = b.value + share * (a.value - b.value);
    if (!gradient) continue;
    gradients[i] = b.gradient + (a.gradient - b.gradient) * share;
    if (sum > 0)
      gradients[i] += (a.weight_gradient * (1 - share) - b.weight_gradient * share) * ((a.value - b.value) / sum);
  }
}

}  // namespace sansmesh
#endif
