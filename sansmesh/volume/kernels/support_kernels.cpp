#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/volume/kernels/support_kernels.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include "sansmesh/core/portable-inl.h"
#include "sansmesh/volume/kernels/local_monomials-inl.h"
#include "sansmesh/volume/kernels/support_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace pn = portable::HWY_NAMESPACE;

using SupportTag = hn::CappedTag<float, 16>;
using SupportV = hn::Vec<SupportTag>;

template <bool kGradient>
void SumSupportsT(const SupportTerm* terms, std::size_t count, std::size_t n, SupportTile& tile) {
  const SupportTag d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const auto px = hn::Load(d, tile.x[0] + i), py = hn::Load(d, tile.x[1] + i), pz = hn::Load(d, tile.x[2] + i);
    SupportV weight = zero, value = zero;
    SupportV ws[3] = {zero, zero, zero}, vs[3] = {zero, zero, zero};
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
      const auto q = hn::IfThenElseZero(in, hn::Sub(one, r2));
      const auto q3 = hn::Mul(hn::Mul(hn::Mul(q, q), q), hn::Set(d, t.scale));
      const auto w0 = hn::Mul(q3, q);
      const auto slope = hn::Neg(hn::Mul(q3, hn::Set(d, 4.0f)));  // dw/d(r²)
      SupportV p, pu = zero, pv = zero, pw = zero;
      SumMonomials<kGradient>(d, t.degree, t.coefficients, u, v, w, p, pu, pv, pw);
      p = hn::Add(p, hn::Set(d, t.constant));
      const auto least = hn::Set(d, t.least), most = hn::Set(d, t.most);
      if (kGradient && t.degree > 0) {
        const auto free = hn::And(hn::Ge(p, least), hn::Le(p, most));
        pu = hn::IfThenElseZero(free, pu), pv = hn::IfThenElseZero(free, pv), pw = hn::IfThenElseZero(free, pw);
      }
      p = hn::Min(hn::Max(p, least), most);
      weight = hn::Add(weight, w0);
      value = pn::MulAdd(w0, p, value);
      if (kGradient) {
        const auto two = hn::Set(d, 2.0f * t.inverse_square);
        for (int k = 0; k < 3; ++k) {
          const auto& rows = t.metric.rows;
          const auto back = [&](const SupportV& a, const SupportV& b, const SupportV& c) HWY_ATTR {
            const auto e = static_cast<std::size_t>(k);
            return pn::MulAdd(a, hn::Set(d, rows[0][e]),
                              pn::MulAdd(b, hn::Set(d, rows[1][e]), hn::Mul(c, hn::Set(d, rows[2][e]))));
          };
          const auto rise = hn::Mul(slope, hn::Mul(two, back(u, v, w)));  // ∂w/∂x_k
          ws[k] = hn::Add(rise, ws[k]);
          vs[k] = pn::MulAdd(rise, p, vs[k]);
          if (t.degree > 0) vs[k] = pn::MulAdd(w0, back(pu, pv, pw), vs[k]);
        }
      }
    }
    hn::Store(weight, d, tile.weight + i), hn::Store(value, d, tile.value + i);
    if (kGradient)
      for (int k = 0; k < 3; ++k)
        hn::Store(ws[k], d, tile.weight_slope[k] + i), hn::Store(vs[k], d, tile.value_slope[k] + i);
  }
}

void SumSupports(const SupportTerm* terms, std::size_t count, std::size_t n, bool gradient, SupportTile& tile) {
  gradient ? SumSupportsT<true>(terms, count, n, tile) : SumSupportsT<false>(terms, count, n, tile);
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(SumSupports);
void sum_supports(const SupportTerm* terms, std::size_t count, std::size_t n, bool gradient, SupportTile& tile) {
  HWY_DYNAMIC_DISPATCH(SumSupports)(terms, count, n, gradient, tile);
}

}  // namespace sansmesh::inline v1::detail
#endif
