// Vectorised values and gradients of polynomials in three variables. Included once for each instruction set.
#if defined(SANSMESH_VOLUME_LOCAL_MONOMIALS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SANSMESH_VOLUME_LOCAL_MONOMIALS_INL_H_
#undef SANSMESH_VOLUME_LOCAL_MONOMIALS_INL_H_
#else
#define SANSMESH_VOLUME_LOCAL_MONOMIALS_INL_H_
#endif

#include <hwy/highway.h>

#include <array>

#include "sansmesh/core/portable-inl.h"
#include "sansmesh/volume/samples/monomial_table.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace pn = portable::HWY_NAMESPACE;

/// Σ_{j >= 1} c[j − 1] monomial_j(x, y, z) up to the degree, and its derivatives if kGradient.
template <int kDegree, bool kGradient, class D, class V = hn::Vec<D>>
HWY_INLINE void SumMonomials(D d, const float* HWY_RESTRICT c, V x, V y, V z, V& value, V& gx, V& gy, V& gz) {
  constexpr int kTerms = (kDegree + 1) * (kDegree + 2) * (kDegree + 3) / 6;
  constexpr const MonomialTable& t = kMonomials;
  V m[kTerms];
  m[0] = hn::Set(d, 1.0f);
  const V u[3] = {x, y, z};
  V g[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  value = hn::Zero(d);
#pragma GCC unroll 40
  for (int j = 1; j < kTerms; ++j) {
    const V k = hn::Set(d, c[j - 1]);
    m[j] = t.predecessor[j] == 0 ? u[t.variable[j]] : hn::Mul(u[t.variable[j]], m[t.predecessor[j]]);
    value = pn::MulAdd(k, m[j], value);
    if (kGradient) {
      for (int a = 0; a < 3; ++a) {
        if (t.exponent[j][a] == 0) continue;
        const V s = hn::Set(d, static_cast<float>(t.exponent[j][a]) * c[j - 1]);
        g[a] = t.lower[j][a] == 0 ? hn::Add(g[a], s) : pn::MulAdd(s, m[t.lower[j][a]], g[a]);
      }
    }
  }
  if (kGradient) gx = g[0], gy = g[1], gz = g[2];
}

/// The same for a degree known at run time, 0..4.
template <bool kGradient, class D, class V = hn::Vec<D>>
HWY_INLINE void SumMonomials(D d, int degree, const float* HWY_RESTRICT c, V x, V y, V z, V& value, V& gx, V& gy,
                             V& gz) {
  switch (degree) {
    case 0:
      value = hn::Zero(d);
      if (kGradient) gx = gy = gz = hn::Zero(d);
      return;
    case 1:
      return SumMonomials<1, kGradient>(d, c, x, y, z, value, gx, gy, gz);
    case 2:
      return SumMonomials<2, kGradient>(d, c, x, y, z, value, gx, gy, gz);
    case 3:
      return SumMonomials<3, kGradient>(d, c, x, y, z, value, gx, gy, gz);
    default:
      return SumMonomials<4, kGradient>(d, c, x, y, z, value, gx, gy, gz);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#endif
