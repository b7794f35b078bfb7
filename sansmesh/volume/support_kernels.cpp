#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/volume/support_kernels.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include "sansmesh/core/portable-inl.h"
#include "sansmesh/volume/local_monomials-inl.h"
#include "sansmesh/volume/support_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace pn = portable::HWY_NAMESPACE;

using SupportTag = hn::CappedTag<float, 16>;
using SupportV = hn::Vec<SupportTag>;

template <bool kGradient, bool kLaguerre>
void SumSupportsT(const SupportTerm* terms, std::size_t count, const SupportShape& shape, std::size_t n,
                  SupportTile& tile) {
  const SupportTag d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const auto px = hn::Load(d, tile.x[0] + i), py = hn::Load(d, tile.x[1] + i), pz = hn::Load(d, tile.x[2] + i);
    SupportV weight = zero, size = zero, value = zero;
    SupportV ws[3] = {zero, zero, zero}, ss[3] = {zero, zero, zero}, vs[3] = {zero, zero, zero};
    for (std::size_t s = 0; s < count; ++s) {
      const SupportTerm& t = terms[s];
      const auto x = hn::Sub(px, hn::Set(d, t.center.x)), y = hn::Sub(py, hn::Set(d, t.center.y)),
                 z = hn::Sub(pz, hn::Set(d, t.center.z));
      const auto along = [&](const Vec3f& row) HWY_ATTR {
        return pn::MulAdd(x, hn::Set(d, row.x), pn::MulAdd(y, hn::Set(d, row.y), hn::Mul(z, hn::Set(d, row.z))));
      };
      const auto u = along(t.metric.rows[0]), v = along(t.metric.rows[1]), w = along(t.metric.rows[2]);
      const auto r2 = hn::Mul(pn::MulAdd(u, u, pn::MulAdd(v, v, hn::Mul(w, w))), hn::Set(d, t.inverse_square));
      const auto in = hn::Lt(r2, one);
      if (hn::AllFalse(d, in)) continue;
      const auto q = hn::IfThenElseZero(in, hn::Sub(one, r2)), q3 = hn::Mul(hn::Mul(q, q), q);
      SupportV fall = one;
      if (shape.fall > 0) fall = pn::Exp(hn::Mul(r2, hn::Set(d, -shape.fall)));
      const auto w0 = hn::Mul(hn::Mul(q3, q), fall);
      // dw/d(r²) = −(fall (1 − r²) + 4) (1 − r²)³ e
      const auto slope = hn::Neg(hn::Mul(hn::Mul(q3, fall), pn::MulAdd(hn::Set(d, shape.fall), q, hn::Set(d, 4.0f))));
      SupportV phi = w0, phi_slope = slope;
      if (kLaguerre) {
        const auto l = pn::MulAdd(r2, pn::MulAdd(r2, hn::Set(d, shape.l2), hn::Set(d, shape.l1)), hn::Set(d, shape.l0));
        const auto m = pn::MulAdd(r2, hn::Set(d, 2 * shape.l2), hn::Set(d, shape.l1));
        phi = hn::Mul(w0, l);
        phi_slope = pn::MulAdd(slope, l, hn::Mul(w0, m));
      }
      SupportV p, pu = zero, pv = zero, pw = zero;
      SumMonomials<kGradient>(d, t.degree, t.coefficients, u, v, w, p, pu, pv, pw);
      p = hn::Add(p, hn::Set(d, t.constant));
      weight = hn::Add(weight, w0);
      value = pn::MulAdd(phi, p, value);
      if (kLaguerre) size = hn::Add(size, hn::Abs(phi));
      if (kGradient) {
        const auto two = hn::Set(d, 2.0f * t.inverse_square);
        for (int k = 0; k < 3; ++k) {
          const auto& rows = t.metric.rows;
          const auto back = [&](const SupportV& a, const SupportV& b, const SupportV& c) HWY_ATTR {
            const auto e = static_cast<std::size_t>(k);
            return pn::MulAdd(a, hn::Set(d, rows[0][e]),
                              pn::MulAdd(b, hn::Set(d, rows[1][e]), hn::Mul(c, hn::Set(d, rows[2][e]))));
          };
          const auto rise = hn::Mul(two, back(u, v, w));  // ∂(r²)/∂x_k
          ws[k] = pn::MulAdd(slope, rise, ws[k]);
          if (kLaguerre) {
            const auto change = hn::Mul(phi_slope, rise);
            ss[k] = hn::Add(ss[k], hn::IfThenElse(hn::Lt(phi, zero), hn::Neg(change), change));
          }
          vs[k] = pn::MulAdd(hn::Mul(phi_slope, rise), p, vs[k]);
          if (t.degree > 0) vs[k] = pn::MulAdd(phi, back(pu, pv, pw), vs[k]);
        }
      }
    }
    hn::Store(weight, d, tile.weight + i), hn::Store(value, d, tile.value + i);
    hn::Store(kLaguerre ? size : weight, d, tile.size + i);
    if (kGradient)
      for (int k = 0; k < 3; ++k) {
        hn::Store(ws[k], d, tile.weight_slope[k] + i), hn::Store(vs[k], d, tile.value_slope[k] + i);
        hn::Store(kLaguerre ? ss[k] : ws[k], d, tile.size_slope[k] + i);
      }
  }
}

void SumSupports(const SupportTerm* terms, std::size_t count, const SupportShape& shape, std::size_t n, bool gradient,
                 SupportTile& tile) {
  const bool laguerre = shape.l1 != 0 || shape.l2 != 0;
  if (gradient) {
    laguerre ? SumSupportsT<true, true>(terms, count, shape, n, tile)
             : SumSupportsT<true, false>(terms, count, shape, n, tile);
  } else {
    laguerre ? SumSupportsT<false, true>(terms, count, shape, n, tile)
             : SumSupportsT<false, false>(terms, count, shape, n, tile);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::detail {
HWY_EXPORT(SumSupports);
void sum_supports(const SupportTerm* terms, std::size_t count, const SupportShape& shape, std::size_t n, bool gradient,
                  SupportTile& tile) {
  HWY_DYNAMIC_DISPATCH(SumSupports)(terms, count, shape, n, gradient, tile);
}

}  // namespace sansmesh::detail
#endif
