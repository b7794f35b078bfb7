// Evaluates batches of points: collects the supports that reach them with the ball tree, then SIMD over points.
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/partition/partition_evaluate.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cmath>

#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/portable-inl.h"
#include "sansmesh/partition/fit/sample_tree.h"
#include "sansmesh/partition/partition_evaluate.h"

#ifndef SANSMESH_PARTITION_EVALUATE_ONCE
#define SANSMESH_PARTITION_EVALUATE_ONCE
namespace sansmesh::inline v1 {
/// Up to kTile points and the sums over supports at each: structure of arrays, aligned for the widest vectors.
struct EvaluationTile {
  static constexpr std::size_t kTile = 64;
  alignas(64) float x[kTile], y[kTile], z[kTile];
  alignas(64) float weight[kTile], value[kTile];      // Σ θ, Σ θ f
  alignas(64) float gx[kTile], gy[kTile], gz[kTile];  // Σ (θ ∇f + f ∇θ)
  alignas(64) float wx[kTile], wy[kTile], wz[kTile];  // Σ ∇θ
};
}  // namespace sansmesh::inline v1
#endif

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace pn = portable::HWY_NAMESPACE;

// Value of one local function (and gradient if kGradient) at offsets d from its centre. If kSteep, divided by the
// length √(1 + |∇g|²) of its gradient, which makes it a distance to first order even for steep polynomials; `trust` is
// then 1 / (1 + |∇g|²), and (tx, ty, tz) its gradient.
template <bool kGradient, bool kSteep, class D, class V = hn::Vec<D>>
HWY_INLINE void Local(D d, const LocalFunction& f, V dx, V dy, V dz, V& value, V& gx, V& gy, V& gz, V& trust, V& tx,
                      V& ty, V& tz) {
  const auto inv = hn::Set(d, 1.0f / f.scale);
  dx = hn::Mul(dx, inv), dy = hn::Mul(dy, inv), dz = hn::Mul(dz, inv);
  const auto along = [&](const Vec3f& a) HWY_ATTR {
    return pn::MulAdd(dx, hn::Set(d, a.x), pn::MulAdd(dy, hn::Set(d, a.y), hn::Mul(dz, hn::Set(d, a.z))));
  };
  const V u = along(f.xi), v = along(f.eta), w = along(f.nu);
  const float* c = f.coefficient.data();
  const auto K = [&](int i) HWY_ATTR { return hn::Set(d, c[i]); };
  const auto N = [&](float n, int i) HWY_ATTR { return hn::Set(d, n * c[i]); };
  // g = a0(v) + u (a1(v) + u (a2(v) + …)): Horner in u of Horners in v; b are the derivatives of a, e those of b.
  V g, gu = hn::Zero(d), gv = hn::Zero(d), guu = hn::Zero(d), guv = hn::Zero(d), gvv = hn::Zero(d);
  const auto mad = [](V a, V b, V e) HWY_ATTR { return pn::MulAdd(a, b, e); };
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
      return pn::NegMulAdd(gu, hn::Set(d, x), pn::NegMulAdd(gv, hn::Set(d, e), hn::Mul(gw, hn::Set(d, n))));
    };
    gx = back(f.nu.x, f.xi.x, f.eta.x);
    gy = back(f.nu.y, f.xi.y, f.eta.y);
    gz = back(f.nu.z, f.xi.z, f.eta.z);
  }
}

// A function is unreliable at points of its ball that are far from its zero set. Beyond `trusted` the weight falls to 0
// at |f| = R with the fourth power, so that its fourth root, which controls the blend with the far field, falls about
// linearly. Values flatten from `straight` R on, to (1 + straight) / 2 of R, which reduces the difference of functions
// that disagree.
template <bool kGradient, class D, class V = hn::Vec<D>>
HWY_INLINE void Bound(D d, float trusted, float straight, float radius, V& value, V& gx, V& gy, V& gz, V& weight, V& tx,
                      V& ty, V& tz) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const float fall = 1 / (1 - trusted), bend = 1 / (1 - straight);
  const V far = hn::Mul(value, hn::Set(d, 1 / radius)), size = hn::Min(hn::Abs(far), one);
  const V over = hn::Max(pn::MulSub(far, far, hn::Set(d, trusted)), zero);
  const V near = hn::Max(pn::NegMulAdd(over, hn::Set(d, fall), one), zero), near2 = hn::Mul(near, near),
          near4 = hn::Mul(near2, near2);
  if (kGradient) {
    const V turn = hn::IfThenElseZero(hn::Gt(over, zero), hn::Mul(far, hn::Mul(near2, near)));
    const V slope = hn::Mul(hn::Mul(weight, turn), hn::Set(d, -8 * fall / radius));
    tx = pn::MulAdd(tx, near4, hn::Mul(slope, gx));
    ty = pn::MulAdd(ty, near4, hn::Mul(slope, gy));
    tz = pn::MulAdd(tz, near4, hn::Mul(slope, gz));
  }
  weight = hn::Mul(weight, near4);
  const V excess = hn::Max(hn::Sub(size, hn::Set(d, straight)), zero);
  const V flat = pn::NegMulAdd(hn::Mul(excess, excess), hn::Set(d, 0.5f * bend), size);
  value = hn::CopySign(hn::Mul(flat, hn::Set(d, radius)), value);
  if (kGradient) {
    const V slope = pn::NegMulAdd(excess, hn::Set(d, bend), one);
    gx = hn::Mul(gx, slope), gy = hn::Mul(gy, slope), gz = hn::Mul(gz, slope);
  }
}

template <bool kGradient>
void SumSupportsT(const LocalFunction* functions, const std::uint8_t* manner, const std::uint32_t* list,
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
      const V t = hn::Mul(pn::MulAdd(dx, dx, pn::MulAdd(dy, dy, hn::Mul(dz, dz))), hn::Set(d, inverse));
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
      if ((manner[list[s]] & kNormalised) != 0) {
        V trust, ux = zero, uy = zero, uz = zero;
        Local<kGradient, true>(d, *f, dx, dy, dz, fv, fx, fy, fz, trust, ux, uy, uz);
        if (f->next == 0) {
          if (kGradient) {
            tx = pn::MulAdd(tx, trust, hn::Mul(theta, ux));
            ty = pn::MulAdd(ty, trust, hn::Mul(theta, uy));
            tz = pn::MulAdd(tz, trust, hn::Mul(theta, uz));
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
        if ((manner[g - functions] & kNormalised) != 0) {
          Local<kGradient, true>(d, *g, dx, dy, dz, hv, hx, hy, hz, none, none, none, none);
        } else {
          Local<kGradient, false>(d, *g, dx, dy, dz, hv, hx, hy, hz, none, none, none, none);
        }
        const auto take = convex ? hn::Gt(hv, fv) : hn::Lt(hv, fv);
        fv = hn::IfThenElse(take, hv, fv);
        if (kGradient)
          fx = hn::IfThenElse(take, hx, fx), fy = hn::IfThenElse(take, hy, fy), fz = hn::IfThenElse(take, hz, fz);
      }
      if ((manner[list[s]] & kPlain) != 0) {
        // Σ θ f / Σ θ without corrections.
      } else if (!f->is_constant()) {
        const bool close = (manner[list[s]] & kClose) != 0;
        Bound<kGradient>(d, close ? kTrustedClose : kTrusted, close ? kStraightClose : kStraight, f->radius, fv, fx, fy,
                         fz, theta, tx, ty, tz);
      } else {
        fv = hn::Min(hn::Max(fv, hn::Set(d, -f->radius)), hn::Set(d, f->radius));
      }
      weight = hn::Add(weight, theta);
      value = pn::MulAdd(theta, fv, value);
      if (kGradient) {
        wx = hn::Add(wx, tx), wy = hn::Add(wy, ty), wz = hn::Add(wz, tz);
        gx = pn::MulAdd(theta, fx, pn::MulAdd(fv, tx, gx));
        gy = pn::MulAdd(theta, fy, pn::MulAdd(fv, ty, gy));
        gz = pn::MulAdd(theta, fz, pn::MulAdd(fv, tz, gz));
      }
    }
    hn::Store(weight, d, tile.weight + i), hn::Store(value, d, tile.value + i);
    if (kGradient) {
      hn::Store(gx, d, tile.gx + i), hn::Store(gy, d, tile.gy + i), hn::Store(gz, d, tile.gz + i);
      hn::Store(wx, d, tile.wx + i), hn::Store(wy, d, tile.wy + i), hn::Store(wz, d, tile.wz + i);
    }
  }
}

void SumSupports(const LocalFunction* functions, const std::uint8_t* manner, const std::uint32_t* list,
                 std::size_t count, std::size_t n, bool gradient, EvaluationTile& tile) {
  if (gradient) {
    SumSupportsT<true>(functions, manner, list, count, n, tile);
  } else {
    SumSupportsT<false>(functions, manner, list, count, n, tile);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1 {
HWY_EXPORT(SumSupports);

namespace {

constexpr float kNoWeight = 1e-24f;  // below, the sums of weights are only rounding

/// Error of rough distances of open sheets, over the largest that it could be (GlobalSign::rough_distance), that leaves
/// no doubt about a sign.
constexpr float kRoughError = 0.3f;

/// Destination of values and gradients.
struct Output {
  std::span<double> values;
  std::span<Vec3> gradients;      ///< empty if not requested
  std::span<std::uint8_t> sized;  ///< empty if values have to be exact
  void put(std::size_t i, float value, const Vec3f& gradient) const {
    values[i] = value;
    if (!gradients.empty()) gradients[i] = Vec3(gradient);
  }
};

/// Batch of points where the far field has a share, collected over several tiles and summed together.
struct FarQueries {
  static constexpr std::size_t kMany = 128;
  struct Near {
    std::size_t at;  ///< index in the output
    float weight, value;
    Vec3f gradient, weight_gradient;
  };
  std::vector<Vec3f> x, gradients;
  std::vector<Near> near;
  std::vector<float> values;

  /// Removes the points that `take` accepts by their index.
  template <class Take>
  void take_out(const Take& take) {
    std::size_t kept = 0;
    for (std::size_t j = 0; j < x.size(); ++j)
      if (!take(j)) x[kept] = x[j], near[kept++] = near[j];
    x.resize(kept), near.resize(kept);
  }
};

/// Share of the supports by their weight, and its derivative.
struct NearShare {
  float share, slope;

  /// Linear in the depth, except at both ends.
  explicit NearShare(float weight) {
    constexpr float kRise = 1 / (kFade - kRound);
    const float root = std::sqrt(std::sqrt(weight)), outward = std::sqrt(1 - root), depth = 1 - outward;
    const float first = std::min(depth, kRound), last = std::min(kFade - depth, kRound);
    share = kRise * (depth - 0.5f * kRound);
    if (depth < kRound) share = kRise * 0.5f * first * first / kRound;
    if (depth > kFade - kRound) share = 1 - kRise * 0.5f * last * last / kRound;
    // ∇depth = ∇root / (2 outward), ∇root = root ∇w / (4 w)
    slope = kRise * std::min(first, last) / kRound * root / (8 * weight * outward);
  }
  /// A smooth step in the weight over `plain`, from which on the far field has no share.
  NearShare(float weight, float plain) {
    const float t = weight / plain;
    share = t * t * (3 - 2 * t), slope = 6 * t * (1 - t) / plain;
  }
};

/// Puts the supports' value where the far field's sign is easily found and the same, or only the sign if no support
/// reaches the point; and removes these points.
void take_easy_signs(const FarField& field, FarQueries& far, const Output& out) {
  far.values.resize(far.x.size());
  field.easy_signs(far.x, far.values);
  far.take_out([&](std::size_t j) {
    const FarQueries::Near& near = far.near[j];
    const bool reached = near.weight > 0;
    if (far.values[j] == 0 || (reached && (near.value < 0) != (far.values[j] < 0))) return false;
    out.put(near.at, reached ? near.value : far.values[j], {});
    out.sized[near.at] = reached;
    return true;
  });
}

/// Puts the blend with the rough far field of open sheets, where the error of the latter leaves no doubt about the
/// sign; and removes these points.
void take_rough(const FarField& field, FarQueries& far, float plain, const Output& out) {
  std::vector<float> most(far.x.size());
  far.values.resize(far.x.size());
  field.open.rough_distance(far.x, far.values, most);
  far.take_out([&](std::size_t j) {
    const FarQueries::Near& near = far.near[j];
    const float weight = near.weight;
    const float share = weight <= 0 ? 0 : (plain > 0 ? NearShare(weight, plain) : NearShare(weight)).share;
    const float value = far.values[j] + share * (near.value - far.values[j]);
    if (!(std::abs(value) > kRoughError * (1 - share) * most[j])) return false;
    out.put(near.at, value, {});
    return true;
  });
}

/// `plain`: weight from which the far field has no share in a plain blend; 0 for the default blend.
void hand_over(const FarField& field, FarQueries& far, float plain, const Output& out) {
  const bool gradient = !out.gradients.empty();
  if (!out.sized.empty()) {
    if (field.open.empty()) take_easy_signs(field, far, out);
    if (field.closed.empty()) take_rough(field, far, plain, out);
  }
  far.values.resize(far.x.size());
  far.gradients.resize(gradient ? far.x.size() : 0);
  field.signed_distance(far.x, far.values, far.gradients);
  for (std::size_t j = 0; j < far.x.size(); ++j) {
    const FarQueries::Near& near = far.near[j];
    const Vec3f far_gradient = gradient ? far.gradients[j] : Vec3f{};
    if (near.weight <= 0) {
      out.put(near.at, far.values[j], far_gradient);
      continue;
    }
    const NearShare near_share = plain > 0 ? NearShare(near.weight, plain) : NearShare(near.weight);
    const float apart = near.value - far.values[j];
    out.put(near.at, far.values[j] + near_share.share * apart,
            far_gradient + (near.gradient - far_gradient) * near_share.share +
                near.weight_gradient * (near_share.slope * apart));
  }
  far.x.clear(), far.near.clear();
}

void evaluate_tile(const PartitionState& s, std::span<const Vec3f> x, std::span<const std::size_t> at,
                   const Output& out, std::vector<std::uint32_t>& list, EvaluationTile& tile, FarQueries& far) {
  Box3f box;
  for (const Vec3f& p : x) box.extend(p);
  // Longer lists indicate points too far apart to share one.
  const std::size_t most = x.size() > 8 ? 96 : x.size() > 1 ? 1024 : s.data.supports.size();
  if (!s.tree.touching(box, most, list)) {
    const std::size_t half = x.size() / 2;
    evaluate_tile(s, x.first(half), at.first(half), out, list, tile, far);
    evaluate_tile(s, x.subspan(half), at.subspan(half), out, list, tile, far);
    return;
  }
  const std::size_t n = x.size();
  for (std::size_t i = 0; i < EvaluationTile::kTile; ++i) {
    const Vec3f& p = x[std::min(i, n - 1)];
    tile.x[i] = p.x, tile.y[i] = p.y, tile.z[i] = p.z;
  }
  const bool gradient = !out.gradients.empty();
  HWY_DYNAMIC_DISPATCH(SumSupports)
  (s.data.functions.data(), s.manner.data(), list.data(), list.size(), n, gradient, tile);
  for (std::size_t i = 0; i < n; ++i) {
    FarQueries::Near near{at[i], tile.weight[i] < kNoWeight ? 0 : tile.weight[i], 0, {}, {}};
    if (near.weight > 0) {
      const float inverse = 1 / near.weight;
      near.value = tile.value[i] / near.weight;
      if (gradient) {
        near.weight_gradient = {tile.wx[i], tile.wy[i], tile.wz[i]};
        near.gradient = (Vec3f{tile.gx[i], tile.gy[i], tile.gz[i]} - near.weight_gradient * near.value) * inverse;
      }
    }
    if (near.weight < s.full) {
      far.x.push_back(x[i]);
      far.near.push_back(near);
    } else {
      out.put(near.at, near.value, near.gradient);
    }
  }
}

}  // namespace

void evaluate_partition(const PartitionState& s, std::span<const Vec3> x, std::span<double> values,
                        std::span<Vec3> gradients, std::span<std::uint8_t> sized) {
  const PartitionData& data = s.data;
  const std::size_t n = x.size();
  constexpr std::size_t kTile = EvaluationTile::kTile;
  const auto local = [&](std::size_t i) { return Vec3f(x[i] - data.origin); };

  // Neighbours in space must be neighbours in a tile. Suitably ordered input is used as it is.
  std::vector<std::uint32_t> order;
  const auto code = [&](std::size_t i) {
    const Vec3f p = (local(i) - data.lower) * (1024.0f / data.edge);
    const auto clamp = [](float v) { return index_in<std::uint32_t>(v, 0, 1023); };
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
  const Output out{values, gradients, sized};
  std::fill(sized.begin(), sized.end(), std::uint8_t{1});
  const float plain = data.paper ? s.full : 0;
  parallel_ranges(0, (n + kTile - 1) / kTile, 16, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> list;
    EvaluationTile tile;
    FarQueries far;
    Vec3f px[kTile];
    std::size_t indices[kTile];
    for (std::size_t t = first; t < last; ++t) {
      const std::size_t base = t * kTile, m = std::min(kTile, n - base);
      for (std::size_t i = 0; i < m; ++i) {
        indices[i] = at(base + i);
        px[i] = local(indices[i]);
      }
      evaluate_tile(s, {px, m}, {indices, m}, out, list, tile, far);
      if (far.x.size() >= FarQueries::kMany) hand_over(s.far, far, plain, out);
    }
    hand_over(s.far, far, plain, out);
  });
}

}  // namespace sansmesh::inline v1
#endif
