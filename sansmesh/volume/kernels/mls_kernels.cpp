#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/volume/kernels/mls_kernels.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include "sansmesh/volume/kernels/mls_kernels.h"
#include "sansmesh/volume/samples/monomial_table.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Every product is rounded: fused operations would differ between instruction sets.
using MlsTag = hn::CappedTag<double, 8>;
using MlsV = hn::Vec<MlsTag>;

constexpr std::size_t kMostTerms = MonomialTable::kTerms;
constexpr double kDropped = 2e-3;

HWY_INLINE std::size_t Row(std::size_t j) { return j * (j + 1) / 2; }

// u, w and the monomials of a sample at a vector of points; false where all weights are 0.
struct MlsTerm {
  // Not implicit: an implicit constructor is compiled without an instruction set, which fails on ARM.
  HWY_ATTR MlsTerm() {}
  MlsV d[3], u[3], q, w;
};
HWY_INLINE bool Weigh(MlsTag d, const MlsSample& s, const StarMetric& frame, const MlsV* x, MlsTerm& t) {
  const auto set = [&](float v) HWY_ATTR { return hn::Set(d, static_cast<double>(v)); };
  t.d[0] = hn::Sub(hn::Set(d, s.position.x), x[0]);
  t.d[1] = hn::Sub(hn::Set(d, s.position.y), x[1]);
  t.d[2] = hn::Sub(hn::Set(d, s.position.z), x[2]);
  const auto along = [&](const Vec3f& r) HWY_ATTR {
    return hn::Add(hn::Mul(t.d[0], set(r.x)), hn::Add(hn::Mul(t.d[1], set(r.y)), hn::Mul(t.d[2], set(r.z))));
  };
  const auto a = along(s.metric.rows[0]), b = along(s.metric.rows[1]), c = along(s.metric.rows[2]);
  const auto r2 = hn::Mul(hn::Add(hn::Mul(a, a), hn::Add(hn::Mul(b, b), hn::Mul(c, c))), hn::Set(d, s.inverse_square));
  const auto one = hn::Set(d, 1.0);
  const auto in = hn::Lt(r2, one);
  if (hn::AllFalse(d, in)) return false;
  t.q = hn::IfThenElseZero(in, hn::Sub(one, r2));
  const auto q2 = hn::Mul(t.q, t.q);
  t.w = hn::Mul(q2, q2);
  for (std::size_t k = 0; k < 3; ++k) t.u[k] = along(frame.rows[k]);
  return true;
}

HWY_INLINE void Monomials(MlsTag d, const MlsV* u, std::size_t terms, MlsV* m) {
  m[0] = hn::Set(d, 1.0);
  for (std::size_t j = 1; j < terms; ++j) m[j] = hn::Mul(u[kMonomials.variable[j]], m[kMonomials.predecessor[j]]);
}

// One long function: moments, LDLᵀ and gradients share the same registers and rows.
void SolveMls(const MlsSample* samples, std::size_t count, const StarMetric& frame, int degree, std::size_t n,
              bool gradient, MlsTile& tile) {
  const MlsTag d;
  const std::size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0);
  const auto terms = static_cast<std::size_t>((degree + 1) * (degree + 2) * (degree + 3) / 6);
  tile.moments.resize(Row(terms) * lanes + 8);
  double* a = tile.moments.data();
  a += (64 - reinterpret_cast<std::uintptr_t>(a) % 64) % 64 / sizeof(double);
  const auto at = [&](std::size_t j, std::size_t l) HWY_ATTR { return a + (Row(j) + l) * lanes; };
  for (std::size_t i = 0; i < n; i += lanes) {
    const MlsV x[3] = {hn::Load(d, tile.x[0] + i), hn::Load(d, tile.x[1] + i), hn::Load(d, tile.x[2] + i)};
    MlsV b[kMostTerms], m[kMostTerms];
    for (std::size_t j = 0; j < terms; ++j) b[j] = zero;
    for (std::size_t e = 0; e < Row(terms); ++e) hn::Store(zero, d, a + e * lanes);
    MlsTerm t;
    for (std::size_t s = 0; s < count; ++s) {
      if (!Weigh(d, samples[s], frame, x, t)) continue;
      Monomials(d, t.u, terms, m);
      const auto f = hn::Set(d, samples[s].value);
      for (std::size_t j = 0; j < terms; ++j) {
        const auto wm = hn::Mul(t.w, m[j]);
        b[j] = hn::Add(b[j], hn::Mul(wm, f));
        for (std::size_t l = 0; l <= j; ++l) {
          double* to = at(j, l);
          hn::Store(hn::Add(hn::Load(d, to), hn::Mul(wm, m[l])), d, to);
        }
      }
    }
    const auto sum = hn::Load(d, at(0, 0));
    // A = L D Lᵀ; row j of `a` becomes L, `inverse` holds the inverse of D. y = L⁻¹ b, e = L⁻¹ (1, 0, …).
    MlsV inverse[kMostTerms], y[kMostTerms], e[kMostTerms], solution[kMostTerms], dual[kMostTerms];
    for (std::size_t j = 0; j < terms; ++j) {
      const auto diagonal = hn::Load(d, at(j, j));
      auto pivot = diagonal;
      y[j] = b[j], e[j] = j == 0 ? one : zero;
      for (std::size_t l = 0; l < j; ++l) {
        auto v = hn::Load(d, at(j, l));  // L_jl D_l
        for (std::size_t k = 0; k < l; ++k)
          v = hn::Sub(v, hn::Mul(hn::Load(d, at(j, k)), hn::Mul(hn::Load(d, at(l, k)), hn::Load(d, at(k, k)))));
        const auto factor = hn::Mul(v, inverse[l]);
        hn::Store(factor, d, at(j, l));
        pivot = hn::Sub(pivot, hn::Mul(factor, v));
        y[j] = hn::Sub(y[j], hn::Mul(factor, y[l])), e[j] = hn::Sub(e[j], hn::Mul(factor, e[l]));
      }
      const auto keep = hn::Gt(pivot, hn::Max(hn::Mul(diagonal, hn::Set(d, kDropped)), hn::Set(d, 1e-200)));
      inverse[j] = hn::IfThenElseZero(keep, hn::Div(one, hn::IfThenElse(keep, pivot, one)));
      hn::Store(hn::IfThenElseZero(keep, pivot), d, at(j, j));
    }
    const auto open = hn::Gt(sum, hn::Set(d, 1e-30));
    auto variance = zero;  // Σ e² / D
    for (std::size_t j = 0; j < terms; ++j) variance = hn::Add(variance, hn::Mul(hn::Mul(e[j], e[j]), inverse[j]));
    hn::Store(hn::IfThenElse(open, hn::Mul(variance, sum), hn::Set(d, -1.0)), d, tile.variance + i);
    // Lᵀ c = D⁻¹ y.
    for (std::size_t j = terms; j-- > 0;) {
      auto c = hn::Mul(y[j], inverse[j]), r = hn::Mul(e[j], inverse[j]);
      for (std::size_t l = j + 1; l < terms; ++l) {
        const auto factor = hn::Load(d, at(l, j));
        c = hn::Sub(c, hn::Mul(factor, solution[l])), r = hn::Sub(r, hn::Mul(factor, dual[l]));
      }
      const auto there = hn::And(open, hn::Gt(inverse[j], zero));
      solution[j] = hn::IfThenElseZero(there, c), dual[j] = hn::IfThenElseZero(there, r);
    }
    hn::Store(solution[0], d, tile.value + i);
    if (!gradient) continue;
    // d value = Σ dw_i (λ·m_i) (f_i − c·m_i) for fixed monomials, plus the change of the monomials with x.
    MlsV g[3] = {zero, zero, zero};
    for (std::size_t k = 0; k < 3 && terms > 1; ++k)
      for (std::size_t l = 0; l < 3; ++l)
        g[k] = hn::Add(g[k], hn::Mul(solution[1 + l], hn::Set(d, static_cast<double>(frame.rows[l][k]))));
    for (std::size_t s = 0; s < count; ++s) {
      if (!Weigh(d, samples[s], frame, x, t)) continue;
      Monomials(d, t.u, terms, m);
      auto p = zero, share = zero;
      for (std::size_t j = 0; j < terms; ++j)
        p = hn::Add(p, hn::Mul(solution[j], m[j])), share = hn::Add(share, hn::Mul(dual[j], m[j]));
      const auto miss = hn::Mul(share, hn::Sub(hn::Set(d, samples[s].value), p));
      // w = (1 − r²)⁴, ∂r²/∂x = −2 MᵀM d / radius²
      const auto slope =
          hn::Mul(hn::Mul(hn::Mul(t.q, hn::Mul(t.q, t.q)), hn::Set(d, 8 * samples[s].inverse_square)), miss);
      MlsV in[3];
      const auto& rows = samples[s].metric.rows;
      for (std::size_t l = 0; l < 3; ++l) {
        in[l] = zero;
        for (std::size_t k = 0; k < 3; ++k)
          in[l] = hn::Add(in[l], hn::Mul(t.d[k], hn::Set(d, static_cast<double>(rows[l][k]))));
      }
      for (std::size_t k = 0; k < 3; ++k) {
        auto back = zero;
        for (std::size_t l = 0; l < 3; ++l)
          back = hn::Add(back, hn::Mul(in[l], hn::Set(d, static_cast<double>(rows[l][k]))));
        g[k] = hn::Add(g[k], hn::Mul(slope, back));
      }
    }
    for (std::size_t k = 0; k < 3; ++k) hn::Store(g[k], d, tile.gradient[k] + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(SolveMls);
void solve_mls(const MlsSample* samples, std::size_t count, const StarMetric& frame, int degree, std::size_t n,
               bool gradient, MlsTile& tile) {
  HWY_DYNAMIC_DISPATCH(SolveMls)(samples, count, frame, degree, n, gradient, tile);
}

}  // namespace sansmesh::inline v1::detail
#endif
