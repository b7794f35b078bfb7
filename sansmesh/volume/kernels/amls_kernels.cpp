#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/volume/kernels/amls_kernels.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include "sansmesh/core/portable-inl.h"
#include "sansmesh/volume/kernels/amls_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace pn = portable::HWY_NAMESPACE;

using AmlsTag = hn::CappedTag<float, AmlsBlock::kWide>;
using AmlsV = hn::Vec<AmlsTag>;

constexpr std::size_t kAmlsSums = 12;

// Lanes represent supports. For every vector size sums go to sixteen lanes, which are added in a fixed
// order. One long function, since its sums must stay in registers.
template <bool kGradient, bool kLaguerre>
void SumAmlsT(const float* HWY_RESTRICT blocks, std::size_t count, std::size_t components, std::size_t component,
              const AmlsLaguerre& laguerre, std::span<const Vec3f> points, AmlsSums* HWY_RESTRICT out) {
  const AmlsTag d;
  constexpr std::size_t kWide = AmlsBlock::kWide;
  const std::size_t stride = AmlsBlock::floats(components);
  const std::size_t own = kWide * (AmlsBlock::kShared + AmlsBlock::kOwn * component);
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  constexpr float kFall = 2;
  HWY_ALIGN float sums[kAmlsSums][kWide];
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto px = hn::Set(d, points[i].x), py = hn::Set(d, points[i].y), pz = hn::Set(d, points[i].z);
    for (std::size_t h = 0; h < kWide; h += hn::Lanes(d)) {
      AmlsV weight = zero, size = zero, value = zero;
      AmlsV ws0 = zero, ws1 = zero, ws2 = zero, ss0 = zero, ss1 = zero, ss2 = zero, vs0 = zero, vs1 = zero, vs2 = zero;
      for (std::size_t b = 0; b < count; ++b) {
        const float* HWY_RESTRICT at = blocks + b * stride + h;
        const auto row = [&](std::size_t r) HWY_ATTR { return hn::Load(d, at + kWide * r); };
        const auto x = hn::Sub(px, row(0)), y = hn::Sub(py, row(1)), z = hn::Sub(pz, row(2));
        const auto m00 = row(3), m01 = row(4), m02 = row(5), m10 = row(6), m11 = row(7), m12 = row(8), m20 = row(9),
                   m21 = row(10), m22 = row(11), inverse = row(12);
        const auto u = pn::MulAdd(x, m00, pn::MulAdd(y, m01, hn::Mul(z, m02)));
        const auto v = pn::MulAdd(x, m10, pn::MulAdd(y, m11, hn::Mul(z, m12)));
        const auto w = pn::MulAdd(x, m20, pn::MulAdd(y, m21, hn::Mul(z, m22)));
        const auto t = hn::Mul(pn::MulAdd(u, u, pn::MulAdd(v, v, hn::Mul(w, w))), inverse);
        const auto in = hn::Lt(t, one);
        if (hn::AllFalse(d, in)) continue;
        const auto q = hn::IfThenElseZero(in, hn::Sub(one, t));
        const auto s = hn::IfThenElseZero(in, t);  // unused lanes are infinitely far away
        const auto q3 = hn::Mul(hn::Mul(hn::Mul(q, q), q), pn::Exp(hn::Mul(t, hn::Set(d, -kFall))));
        const auto w0 = hn::Mul(q3, q);
        // dw/dt = −(2 (1 − t) + 4) (1 − t)³ e
        const auto slope = hn::Neg(hn::Mul(q3, pn::MulAdd(hn::Set(d, kFall), q, hn::Set(d, 4.0f))));
        AmlsV phi = w0, phi_slope = slope;
        if (kLaguerre) {
          const auto l =
              pn::MulAdd(s, pn::MulAdd(s, hn::Set(d, laguerre.l2), hn::Set(d, laguerre.l1)), hn::Set(d, laguerre.l0));
          phi = hn::Mul(w0, l);
          phi_slope =
              pn::MulAdd(slope, l, hn::Mul(w0, pn::MulAdd(s, hn::Set(d, 2 * laguerre.l2), hn::Set(d, laguerre.l1))));
        }
        const float* HWY_RESTRICT mine = blocks + b * stride + own + h;
        const auto term = [&](std::size_t r) HWY_ATTR { return hn::Load(d, mine + kWide * r); };
        const auto xx = term(4), xy = term(5), xz = term(6), yy = term(7), yz = term(8), zz = term(9);
        // p = c + u (a + xx u + xy v + xz w) + v (b + yy v + yz w) + w (c + zz w)
        const auto pu = pn::MulAdd(xx, u, pn::MulAdd(xy, v, pn::MulAdd(xz, w, term(1))));
        const auto pv = pn::MulAdd(yy, v, pn::MulAdd(yz, w, term(2)));
        const auto pw = pn::MulAdd(zz, w, term(3));
        const auto p = pn::MulAdd(u, pu, pn::MulAdd(v, pv, pn::MulAdd(w, pw, term(0))));
        weight = hn::Add(weight, w0);
        value = pn::MulAdd(phi, p, value);
        if (kLaguerre) size = hn::Add(size, hn::Abs(phi));
        if (kGradient) {
          const auto gu = pn::MulAdd(xx, u, pu);
          const auto gv = pn::MulAdd(yy, v, pn::MulAdd(xy, u, pv));
          const auto gw = pn::MulAdd(zz, w, pn::MulAdd(yz, v, pn::MulAdd(xz, u, pw)));
          const auto two = hn::Add(inverse, inverse);
          // Gradients by u, then by x.
          const auto rise = hn::Mul(two, slope);
          ws0 = pn::MulAdd(rise, pn::MulAdd(u, m00, pn::MulAdd(v, m10, hn::Mul(w, m20))), ws0);
          ws1 = pn::MulAdd(rise, pn::MulAdd(u, m01, pn::MulAdd(v, m11, hn::Mul(w, m21))), ws1);
          ws2 = pn::MulAdd(rise, pn::MulAdd(u, m02, pn::MulAdd(v, m12, hn::Mul(w, m22))), ws2);
          const auto phi_rise = hn::Mul(two, phi_slope), by = hn::Mul(phi_rise, p);
          const auto au = pn::MulAdd(by, u, hn::Mul(phi, gu)), av = pn::MulAdd(by, v, hn::Mul(phi, gv)),
                     aw = pn::MulAdd(by, w, hn::Mul(phi, gw));
          vs0 = hn::Add(vs0, pn::MulAdd(au, m00, pn::MulAdd(av, m10, hn::Mul(aw, m20))));
          vs1 = hn::Add(vs1, pn::MulAdd(au, m01, pn::MulAdd(av, m11, hn::Mul(aw, m21))));
          vs2 = hn::Add(vs2, pn::MulAdd(au, m02, pn::MulAdd(av, m12, hn::Mul(aw, m22))));
          if (kLaguerre) {
            const auto change = hn::IfThenElse(hn::Lt(phi, zero), hn::Neg(phi_rise), phi_rise);
            ss0 = pn::MulAdd(change, pn::MulAdd(u, m00, pn::MulAdd(v, m10, hn::Mul(w, m20))), ss0);
            ss1 = pn::MulAdd(change, pn::MulAdd(u, m01, pn::MulAdd(v, m11, hn::Mul(w, m21))), ss1);
            ss2 = pn::MulAdd(change, pn::MulAdd(u, m02, pn::MulAdd(v, m12, hn::Mul(w, m22))), ss2);
          }
        }
      }
      hn::Store(weight, d, sums[0] + h), hn::Store(value, d, sums[1] + h);
      if (kGradient) {
        hn::Store(ws0, d, sums[2] + h), hn::Store(ws1, d, sums[3] + h), hn::Store(ws2, d, sums[4] + h);
        hn::Store(vs0, d, sums[5] + h), hn::Store(vs1, d, sums[6] + h), hn::Store(vs2, d, sums[7] + h);
      }
      if (kLaguerre) hn::Store(size, d, sums[8] + h);
      if (kLaguerre && kGradient)
        hn::Store(ss0, d, sums[9] + h), hn::Store(ss1, d, sums[10] + h), hn::Store(ss2, d, sums[11] + h);
    }
    const auto total = [&](std::size_t of) HWY_ATTR {
      float* s = sums[of];
      for (std::size_t half = kWide / 2; half > 0; half /= 2)
        for (std::size_t k = 0; k < half; ++k) s[k] += s[k + half];
      return s[0];
    };
    AmlsSums& o = out[i];
    o.weight = total(0), o.value = total(1);
    o.size = kLaguerre ? total(8) : o.weight;
    if (!kGradient) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      o.weight_slope[k] = total(2 + k), o.value_slope[k] = total(5 + k);
      o.size_slope[k] = kLaguerre ? total(9 + k) : o.weight_slope[k];
    }
  }
}

void SumAmls(const float* blocks, std::size_t count, std::size_t components, std::size_t component,
             const AmlsLaguerre& laguerre, std::span<const Vec3f> x, bool gradient, AmlsSums* sums) {
  const bool rings = laguerre.l1 != 0 || laguerre.l2 != 0;
  const auto sum = gradient ? (rings ? SumAmlsT<true, true> : SumAmlsT<true, false>)
                            : (rings ? SumAmlsT<false, true> : SumAmlsT<false, false>);
  sum(blocks, count, components, component, laguerre, x, sums);
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(SumAmls);
void sum_amls(const float* blocks, std::size_t block_count, std::size_t components, std::size_t component,
              const AmlsLaguerre& laguerre, std::span<const Vec3f> x, bool gradient, AmlsSums* sums) {
  HWY_DYNAMIC_DISPATCH(SumAmls)(blocks, block_count, components, component, laguerre, x, gradient, sums);
}

}  // namespace sansmesh::inline v1::detail
#endif
