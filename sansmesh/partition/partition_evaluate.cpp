// Batches of points against the supports that reach them: gather supports with the box tree, then SIMD over points.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/partition/partition_evaluate.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sansmesh/core/parallel.h"
#include "sansmesh/partition/partition_state.h"
#include "sansmesh/partition/sample_tree.h"

#ifndef SANSMESH_PARTITION_EVALUATE_ONCE
#define SANSMESH_PARTITION_EVALUATE_ONCE
namespace sansmesh {
/// Square of f/R up to which a support's weight is left alone: noisy samples lie that far off their fits.
constexpr float kTrusted = 0.25f;

/// Up to kTile points and the sums over supports at each: structure of arrays, aligned for the widest vectors.
struct EvaluationTile {
  static constexpr std::size_t kTile = 64;
  alignas(64) float x[kTile], y[kTile], z[kTile];
  alignas(64) float weight[kTile], value[kTile];      // Σ θ, Σ θ f
  alignas(64) float gx[kTile], gy[kTile], gz[kTile];  // Σ (θ ∇f + f ∇θ)
  alignas(64) float wx[kTile], wy[kTile], wz[kTile];  // Σ ∇θ
};
}  // namespace sansmesh
#endif

HWY_BEFORE_NAMESPACE();
namespace sansmesh {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Value of one local function (and gradient if kGradient) at offsets d from its centre. If kSteep it is divided by the
// length √(1 + |∇g|²) of its gradient: a distance to first order however steep the polynomial; `trust` is then
// 1 / (1 + |∇g|²), and (tx, ty, tz) its gradient.
template <bool kGradient, bool kSteep, class D, class V = hn::Vec<D>>
HWY_INLINE void Local(D d, const LocalFunction& f, V dx, V dy, V dz, V& value, V& gx, V& gy, V& gz, V& trust, V& tx,
                      V& ty, V& tz) {
  const auto inv = hn::Set(d, 1.0f / f.scale);
  dx = hn::Mul(dx, inv), dy = hn::Mul(dy, inv), dz = hn::Mul(dz, inv);
  const auto along = [&](const Vec3f& a) HWY_ATTR {
    return hn::MulAdd(dx, hn::Set(d, a.x), hn::MulAdd(dy, hn::Set(d, a.y), hn::Mul(dz, hn::Set(d, a.z))));
  };
  const V u = along(f.xi), v = along(f.eta), w = along(f.nu);
  const float* c = f.coefficient.data();
  const auto K = [&](int i) HWY_ATTR { return hn::Set(d, c[i]); };
  const auto N = [&](float n, int i) HWY_ATTR { return hn::Set(d, n * c[i]); };
  // g = a0(v) + u (a1(v) + u (a2(v) + …)): Horner in u of Horners in v; b are the derivatives of a, e those of b.
  V g, gu = hn::Zero(d), gv = hn::Zero(d), guu = hn::Zero(d), guv = hn::Zero(d), gvv = hn::Zero(d);
  const auto mad = [](V a, V b, V e) HWY_ATTR { return hn::MulAdd(a, b, e); };
  if (f.degree <= 2) {
    const V a0 = mad(v, mad(v, K(5), K(2)), K(0));
    const V a1 = mad(v, K(4), K(1));
    g = mad(u, mad(u, K(3), a1), a0);
    if (kGradient || kSteep) {
      gu = mad(u, N(2, 3), a1);
      gv = mad(u, K(4), mad(v, N(2, 5), K(2)));
    }
    if (kGradient && kSteep) guu = N(2, 3), guv = K(4), gvv = N(2, 5);
  } else {
    const V a0 = mad(v, mad(v, mad(v, mad(v, K(14), K(9)), K(5)), K(2)), K(0));
    const V a1 = mad(v, mad(v, mad(v, K(13), K(8)), K(4)), K(1));
    const V a2 = mad(v, mad(v, K(12), K(7)), K(3));
    const V a3 = mad(v, K(11), K(6));
    g = mad(u, mad(u, mad(u, mad(u, K(10), a3), a2), a1), a0);
    if (kGradient || kSteep) {
      const auto two = hn::Set(d, 2.0f), three = hn::Set(d, 3.0f);
      gu = mad(u, mad(u, mad(u, N(4, 10), hn::Mul(three, a3)), hn::Mul(two, a2)), a1);
      const V b0 = mad(v, mad(v, mad(v, N(4, 14), N(3, 9)), N(2, 5)), K(2));
      const V b1 = mad(v, mad(v, N(3, 13), N(2, 8)), K(4));
      const V b2 = mad(v, N(2, 12), K(7));
      gv = mad(u, mad(u, mad(u, K(11), b2), b1), b0);
      if (kGradient && kSteep) {
        guu = mad(u, mad(u, N(12, 10), hn::Mul(hn::Set(d, 6.0f), a3)), hn::Mul(two, a2));
        guv = mad(u, mad(u, N(3, 11), hn::Mul(two, b2)), b1);
        const V e0 = mad(v, mad(v, N(12, 14), N(6, 9)), N(2, 5));
        const V e1 = mad(v, N(6, 13), N(2, 8));
        gvv = mad(u, mad(u, N(2, 12), e1), e0);
      }
    }
  }
  V height = hn::Sub(w, g), gw = hn::Set(d, 1.0f);
  if (kSteep) {
    const V shrink = hn::Div(gw, hn::Sqrt(mad(gu, gu, mad(gv, gv, gw))));
    height = hn::Mul(height, shrink);
    trust = hn::Mul(shrink, shrink);
    if (kGradient) {
      const V bend = hn::Mul(height, trust);
      const V hu = mad(gu, guu, hn::Mul(gv, guv)), hv = mad(gu, guv, hn::Mul(gv, gvv));
      const V fall = hn::Mul(hn::Mul(trust, trust), hn::Set(d, -2.0f / f.scale));
      const V tu = hn::Mul(fall, hu), tv = hn::Mul(fall, hv);
      tx = mad(tu, hn::Set(d, f.xi.x), hn::Mul(tv, hn::Set(d, f.eta.x)));
      ty = mad(tu, hn::Set(d, f.xi.y), hn::Mul(tv, hn::Set(d, f.eta.y)));
      tz = mad(tu, hn::Set(d, f.xi.z), hn::Mul(tv, hn::Set(d, f.eta.z)));
      gu = mad(bend, hu, hn::Mul(gu, shrink)), gv = mad(bend, hv, hn::Mul(gv, shrink)), gw = shrink;
    }
  }
  value = hn::Mul(height, hn::Set(d, f.scale));
  if (kGradient) {
    const auto back = [&](float n, float x, float e) HWY_ATTR {
      return hn::NegMulAdd(gu, hn::Set(d, x), hn::NegMulAdd(gv, hn::Set(d, e), hn::Mul(gw, hn::Set(d, n))));
    };
    gx = back(f.nu.x, f.xi.x, f.eta.x);
    gy = back(f.nu.y, f.xi.y, f.eta.y);
    gz = back(f.nu.z, f.xi.z, f.eta.z);
  }
}

template <bool kGradient>
void SumSupportsT(const LocalFunction* functions, const std::uint8_t* steep, const std::uint32_t* list,
                  std::size_t count, std::size_t n, EvaluationTile& tile) {
  const hn::ScalableTag<float> d;
  using V = hn::Vec<decltype(d)>;
  const std::size_t lanes = hn::Lanes(d);
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (std::size_t i = 0; i < n; i += lanes) {
    const V x = hn::Load(d, tile.x + i), y = hn::Load(d, tile.y + i), z = hn::Load(d, tile.z + i);
    V weight = zero, value = zero, gx = zero, gy = zero, gz = zero, wx = zero, wy = zero, wz = zero;
    for (std::size_t s = 0; s < count; ++s) {
      const LocalFunction* f = functions + list[s];
      const V dx = hn::Sub(x, hn::Set(d, f->center.x)), dy = hn::Sub(y, hn::Set(d, f->center.y)),
              dz = hn::Sub(z, hn::Set(d, f->center.z));
      const float inverse = 1.0f / (f->radius * f->radius);
      const V t = hn::Mul(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))), hn::Set(d, inverse));
      const auto in = hn::Lt(t, one);
      if (hn::AllFalse(d, in)) continue;
      const V q = hn::IfThenElseZero(in, hn::Sub(one, t));
      const V q2 = hn::Mul(q, q);
      V theta = hn::Mul(q2, q2);
      V tx = zero, ty = zero, tz = zero;
      if (kGradient) {
        // ∇θ = −8 (1 − t)³ d / R²
        const V slope = hn::Mul(hn::Mul(q2, q), hn::Set(d, -8.0f * inverse));
        tx = hn::Mul(slope, dx), ty = hn::Mul(slope, dy), tz = hn::Mul(slope, dz);
      }
      V fv, fx = zero, fy = zero, fz = zero;
      if (steep[list[s]] != 0) {
        V trust, ux = zero, uy = zero, uz = zero;
        Local<kGradient, true>(d, *f, dx, dy, dz, fv, fx, fy, fz, trust, ux, uy, uz);
        if (f->next == 0) {
          if (kGradient) {
            tx = hn::MulAdd(tx, trust, hn::Mul(theta, ux));
            ty = hn::MulAdd(ty, trust, hn::Mul(theta, uy));
            tz = hn::MulAdd(tz, trust, hn::Mul(theta, uz));
          }
          theta = hn::Mul(theta, trust);
        }
      } else {
        V none = zero;
        Local<kGradient, false>(d, *f, dx, dy, dz, fv, fx, fy, fz, none, none, none, none);
      }
      for (const LocalFunction* g = f; g->next != 0;) {
        const bool convex = g->convex != 0;
        g = functions + (g->next - 1);
        V hv, hx = zero, hy = zero, hz = zero, none = zero;
        if (steep[g - functions] != 0) {
          Local<kGradient, true>(d, *g, dx, dy, dz, hv, hx, hy, hz, none, none, none, none);
        } else {
          Local<kGradient, false>(d, *g, dx, dy, dz, hv, hx, hy, hz, none, none, none, none);
        }
        const auto take = convex ? hn::Gt(hv, fv) : hn::Lt(hv, fv);
        fv = hn::IfThenElse(take, hv, fv);
        if (kGradient)
          fx = hn::IfThenElse(take, hx, fx), fy = hn::IfThenElse(take, hy, fy), fz = hn::IfThenElse(take, hz, fz);
      }
      if (!f->is_constant()) {
        // Beyond f² = R²/4 weights fall to 0 at |f| = R: what is far from its zero set in the ball says little about
        // what is there.
        const float reach = inverse * f->radius;
        const V far = hn::Mul(fv, hn::Set(d, reach));
        const V over = hn::Max(hn::MulSub(far, far, hn::Set(d, kTrusted)), zero);
        const V near = hn::Max(hn::NegMulAdd(over, hn::Set(d, 1 / (1 - kTrusted)), one), zero),
                near2 = hn::Mul(near, near);
        fv = hn::IfThenElseZero(hn::Gt(near, zero), fv);
        if (kGradient) {
          const V turn = hn::IfThenElseZero(hn::Gt(over, zero), hn::Mul(far, near));
          const V slope = hn::Mul(hn::Mul(theta, turn), hn::Set(d, -4 * reach / (1 - kTrusted)));
          tx = hn::MulAdd(tx, near2, hn::Mul(slope, fx));
          ty = hn::MulAdd(ty, near2, hn::Mul(slope, fy));
          tz = hn::MulAdd(tz, near2, hn::Mul(slope, fz));
        }
        theta = hn::Mul(theta, near2);
      } else {
        fv = hn::Min(hn::Max(fv, hn::Set(d, -f->radius)), hn::Set(d, f->radius));
      }
      weight = hn::Add(weight, theta);
      value = hn::MulAdd(theta, fv, value);
      if (kGradient) {
        wx = hn::Add(wx, tx), wy = hn::Add(wy, ty), wz = hn::Add(wz, tz);
        gx = hn::MulAdd(theta, fx, hn::MulAdd(fv, tx, gx));
        gy = hn::MulAdd(theta, fy, hn::MulAdd(fv, ty, gy));
        gz = hn::MulAdd(theta, fz, hn::MulAdd(fv, tz, gz));
      }
    }
    hn::Store(weight, d, tile.weight + i), hn::Store(value, d, tile.value + i);
    if (kGradient) {
      hn::Store(gx, d, tile.gx + i), hn::Store(gy, d, tile.gy + i), hn::Store(gz, d, tile.gz + i);
      hn::Store(wx, d, tile.wx + i), hn::Store(wy, d, tile.wy + i), hn::Store(wz, d, tile.wz + i);
    }
  }
}

void SumSupports(const LocalFunction* functions, const std::uint8_t* steep, const std::uint32_t* list,
                 std::size_t count, std::size_t n, bool gradient, EvaluationTile& tile) {
  if (gradient) {
    SumSupportsT<true>(functions, steep, list, count, n, tile);
  } else {
    SumSupportsT<false>(functions, steep, list, count, n, tile);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh {
HWY_EXPORT(SumSupports);

void SupportTree::build(std::span<const LocalFunction> functions) {
  levels.assign(1, {});
  levels[0].reserve(functions.size());
  for (const LocalFunction& f : functions) {
    const Vec3f r{f.radius, f.radius, f.radius};
    levels[0].push_back({f.center - r, f.center + r});
  }
  while (levels.back().size() > 1) {
    const auto& below = levels.back();
    std::vector<Box3f> above((below.size() + 7) / 8);
    for (std::size_t i = 0; i < below.size(); ++i) above[i / 8].extend(below[i]);
    levels.push_back(std::move(above));
  }
}

bool SupportTree::query(const Box3f& box, std::size_t most, std::vector<std::uint32_t>& found) const {
  const auto meets = [&](const Box3f& b) {
    return b.lower.x <= box.upper.x && b.upper.x >= box.lower.x && b.lower.y <= box.upper.y &&
           b.upper.y >= box.lower.y && b.lower.z <= box.upper.z && b.upper.z >= box.lower.z;
  };
  struct Item {
    std::uint32_t level, index;
  };
  Item stack[128];
  std::size_t top = 0;
  stack[top++] = {static_cast<std::uint32_t>(levels.size() - 1), 0};
  while (top > 0) {
    const Item item = stack[--top];
    if (!meets(levels[item.level][item.index])) continue;
    if (item.level == 0) {
      if (found.size() == most) return false;
      found.push_back(item.index);
      continue;
    }
    const std::size_t count = levels[item.level - 1].size();
    const std::uint32_t first = item.index * 8;
    const auto last = static_cast<std::uint32_t>(std::min<std::size_t>(first + 8, count));
    for (std::uint32_t k = last; k-- > first;) stack[top++] = {item.level - 1, k};
  }
  return true;
}

namespace {

constexpr float kSteep = 2.0f;

/// Whether the function's slope against its plane exceeds kSteep somewhere in its support.
bool is_steep(const LocalFunction& f) {
  const auto& c = f.coefficient;
  for (const float ring : {0.5f, 0.9f})
    for (int k = 0; k < 8; ++k) {
      const float angle = static_cast<float>(k) * std::numbers::pi_v<float> / 4, r = ring * f.radius / f.scale;
      const float u = r * std::cos(angle), v = r * std::sin(angle);
      float gu = 0, gv = 0;
      if (f.degree >= 1) gu = c[1], gv = c[2];
      if (f.degree >= 2) gu += 2 * u * c[3] + v * c[4], gv += u * c[4] + 2 * v * c[5];
      if (f.degree >= 3)
        gu += 3 * u * u * c[6] + 2 * u * v * c[7] + v * v * c[8],
            gv += u * u * c[7] + 2 * u * v * c[8] + 3 * v * v * c[9];
      if (f.degree >= 4)
        gu += 4 * u * u * u * c[10] + 3 * u * u * v * c[11] + 2 * u * v * v * c[12] + v * v * v * c[13],
            gv += u * u * u * c[11] + 2 * u * u * v * c[12] + 3 * u * v * v * c[13] + 4 * v * v * v * c[14];
      if (gu * gu + gv * gv > kSteep * kSteep) return true;
    }
  return false;
}

}  // namespace

PartitionOfUnity::PartitionOfUnity(PartitionData data) : state_(std::make_shared<State>()) {
  state_->data = std::move(data);
  const PartitionData& d = state_->data;
  state_->tree.build(d.functions.view().first(d.supports.size()));
  state_->steep.resize(d.functions.size());
  parallel_for(0, state_->steep.size(), 8192, [&](std::size_t i) { state_->steep[i] = is_steep(d.functions[i]); });
  // Each support's surface patch within its own block: together they tile the surface, and decide inside and outside
  // where no support reaches.
  std::vector<OrientedPatch> patches(d.supports.size());
  parallel_for(0, patches.size(), 8192, [&](std::size_t i) {
    patches[i] = {d.supports[i].foot, d.functions[i].nu * d.supports[i].area};
  });
  state_->sign = GlobalSign(patches, d.edge);
}

Box3 PartitionOfUnity::bounds() const {
  const Vec3 lower = state_->data.origin + Vec3(state_->data.lower);
  const double e = state_->data.edge;
  return {lower, lower + Vec3{e, e, e}};
}
const PartitionData& PartitionOfUnity::data() const { return state_->data; }

namespace {

// Where the fourth root of the supports' weights fades below this, the far field takes over. That root falls about
// linearly towards a rim, so that the hand-over is spread over half of the support.
constexpr float kFade = 0.85f;

constexpr float kNoWeight = 1e-24f;  // rounding of the weights' sums is all that is left below

void evaluate_tile(const PartitionOfUnity::State& s, std::span<const Vec3f> x, std::span<float> values,
                   std::span<Vec3f> gradients, std::vector<std::uint32_t>& list, EvaluationTile& tile) {
  Box3f box;
  for (const Vec3f& p : x) box.extend(p);
  list.clear();
  // Lists longer than this are a sign of points too far apart to share one.
  const std::size_t most = x.size() > 8 ? 96 : x.size() > 1 ? 1024 : s.data.supports.size();
  if (!s.tree.query(box, most, list)) {
    const std::size_t half = x.size() / 2;
    const bool g = !gradients.empty();
    evaluate_tile(s, x.first(half), values.first(half), g ? gradients.first(half) : gradients, list, tile);
    evaluate_tile(s, x.subspan(half), values.subspan(half), g ? gradients.subspan(half) : gradients, list, tile);
    return;
  }
  const std::size_t n = x.size();
  for (std::size_t i = 0; i < EvaluationTile::kTile; ++i) {
    const Vec3f& p = x[std::min(i, n - 1)];
    tile.x[i] = p.x, tile.y[i] = p.y, tile.z[i] = p.z;
  }
  HWY_DYNAMIC_DISPATCH(SumSupports)
  (s.data.functions.data(), s.steep.data(), list.data(), list.size(), n, !gradients.empty(), tile);

  Vec3f far_x[EvaluationTile::kTile];
  std::size_t far_i[EvaluationTile::kTile], far_count = 0;
  const float fade = kFade * kFade * kFade * kFade;
  for (std::size_t i = 0; i < n; ++i) {
    float& w = tile.weight[i];
    if (w < kNoWeight) w = 0;
    if (w > 0) {
      values[i] = tile.value[i] / w;
      if (!gradients.empty()) {
        gradients[i] = Vec3f{tile.gx[i] - values[i] * tile.wx[i], tile.gy[i] - values[i] * tile.wy[i],
                             tile.gz[i] - values[i] * tile.wz[i]} *
                       (1 / w);
      }
    }
    if (w < fade) {
      far_x[far_count] = x[i];
      far_i[far_count++] = i;
    }
  }
  if (far_count == 0) return;
  float far_values[EvaluationTile::kTile];
  Vec3f far_gradients[EvaluationTile::kTile];
  s.sign.signed_distance(std::span<const Vec3f>(far_x, far_count), std::span<float>(far_values, far_count),
                         std::span<Vec3f>(far_gradients, gradients.empty() ? 0 : far_count));
  for (std::size_t j = 0; j < far_count; ++j) {
    const std::size_t i = far_i[j];
    const float w = tile.weight[i];
    const float root = std::sqrt(std::sqrt(w)), t = root / kFade, a = t * t * (3 - 2 * t);
    const float near = w > 0 ? values[i] : far_values[j];
    values[i] = far_values[j] + a * (near - far_values[j]);
    if (gradients.empty()) continue;
    if (w > 0) {
      // ∇a = a′(t) ∇w / (4 w^¾)
      const Vec3f slope = Vec3f{tile.wx[i], tile.wy[i], tile.wz[i]} * (1.5f * t * (1 - t) * root / (kFade * w));
      gradients[i] = far_gradients[j] + (gradients[i] - far_gradients[j]) * a + slope * (near - far_values[j]);
    } else {
      gradients[i] = far_gradients[j];
    }
  }
}

}  // namespace

void PartitionOfUnity::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  const State& s = *state_;
  const PartitionData& data = s.data;
  const std::size_t n = x.size();
  constexpr std::size_t kTile = EvaluationTile::kTile;
  const auto local = [&](std::size_t i) { return Vec3f(x[i] - data.origin); };

  // Neighbours in space must be neighbours in a tile. Input that is already ordered that way is taken as it is.
  std::vector<std::uint32_t> order;
  const auto code = [&](std::size_t i) {
    const Vec3f p = (local(i) - data.lower) * (1024.0f / data.edge);
    const auto clamp = [](float v) { return static_cast<std::uint32_t>(v > 0 ? std::min(v, 1023.0f) : 0); };
    return morton_code(clamp(p.x), clamp(p.y), clamp(p.z));
  };
  if (n > kTile) {
    std::size_t jumps = 0;
    for (std::size_t i = 0; i + 17 < n; i += 16) jumps += code(i) >> 9 != code(i + 1) >> 9;
    if (jumps * 16 > n / 4) {
      std::vector<KeyIndex> keys(n);
      parallel_for(0, n, 8192, [&](std::size_t i) { keys[i] = {code(i), static_cast<unsigned>(i)}; });
      parallel_sort(keys);
      order.resize(n);
      for (std::size_t i = 0; i < n; ++i) order[i] = keys[i].index;
    }
  }
  const auto at = [&](std::size_t i) { return order.empty() ? i : order[i]; };
  parallel_ranges(0, (n + kTile - 1) / kTile, 16, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> list;
    EvaluationTile tile;
    Vec3f px[kTile], gradient[kTile];
    float value[kTile];
    for (std::size_t t = first; t < last; ++t) {
      const std::size_t base = t * kTile, m = std::min(kTile, n - base);
      for (std::size_t i = 0; i < m; ++i) px[i] = local(at(base + i));
      evaluate_tile(s, {px, m}, {value, m}, gradients.empty() ? std::span<Vec3f>{} : std::span<Vec3f>(gradient, m),
                    list, tile);
      for (std::size_t i = 0; i < m; ++i) {
        values[at(base + i)] = value[i];
        if (!gradients.empty()) gradients[at(base + i)] = Vec3(gradient[i]);
      }
    }
  });
}

std::vector<Vec3> PartitionOfUnity::seeds() const {
  const PartitionData& d = state_->data;
  std::vector<Vec3> result(d.supports.size());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = d.origin + Vec3(d.supports[i].foot);
  return result;
}

BlockTree PartitionOfUnity::mesh_blocks(double mesh_error, int deepest) const {
  const PartitionData& s = state_->data;
  BlockTree tree(s.origin + Vec3(s.lower), s.edge);
  struct Item {
    std::size_t block;
    int level;
    std::uint32_t cell;  // in flatness[level]
  };
  const int last = static_cast<int>(s.flatness.size()) - 1;
  std::vector<Item> stack{{0, 0, 0}};
  while (!stack.empty()) {
    const Item item = stack.back();
    stack.pop_back();
    const PartitionData::Flatness& here = s.flatness[static_cast<std::size_t>(item.level)];
    if (here.gap[item.cell] <= mesh_error || item.level >= deepest) continue;
    const std::size_t first = tree.subdivide(item.block);
    if (item.level == last) continue;  // the samples say nothing about finer scales
    const PartitionData::Flatness& below = s.flatness[static_cast<std::size_t>(item.level) + 1];
    for (std::uint32_t c = here.child[item.cell]; c < here.child[item.cell + 1]; ++c)
      stack.push_back({first + (below.code[c] & 7), item.level + 1, c});
  }
  return tree;
}

}  // namespace sansmesh
#endif
