#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/surface/bilateral_kernels.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h (Highway).
#include <hwy/highway.h>

#include "sansmesh/surface/bilateral_kernels.h"
#include "sansmesh/surface/near_normals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {

constexpr float kFarthest = 60;  // larger exponents of exp() have no effect

/// The part of a weight that depends on the distance: the factor of the bilateral formulas, the exponent of laguerre.
/// False if no lane is reached.
template <NormalFormula kFormula>
HWY_INLINE bool ByDistance(const Candidate& c, const V& d2, V& factor) {
  const Tag tag;
  if constexpr (kFormula == NormalFormula::bilateral) {
    const V t = hn::Max(pn::NegMulAdd(d2, Constant(c.inverse_support), Constant(1)), hn::Zero(tag));
    if (hn::AllFalse(tag, hn::Gt(t, hn::Zero(tag)))) return false;
    const V t2 = hn::Mul(t, t);
    factor = hn::Mul(hn::Mul(t2, t2), Constant(c.weight));
    return true;
  }
  const V r = hn::Mul(d2, Constant(c.inverse_support));
  const auto near = hn::Lt(r, Constant(kGaussianEnd));
  if (hn::AllFalse(tag, near)) return false;
  if constexpr (kFormula == NormalFormula::laguerre)
    factor = hn::IfThenElse(near, r, Constant(kFarthest));
  else
    factor = hn::IfThenElseZero(near, hn::Mul(pn::Exp(hn::Neg(r)), Constant(c.weight)));
  return true;
}

template <NormalFormula kFormula>
void Refine(std::span<const Candidate> candidates, const PointGroup& group, int iterations, float inverse_turn,
            GroupNormals& normals) {
  const Tag tag;
  const V zero = hn::Zero(tag), one = Constant(1);
  for (std::size_t at = 0; at < kGroup; at += kLanes) {
    if (at >= group.count && at > 0) break;
    const Lanes p{hn::Load(tag, group.x + at), hn::Load(tag, group.y + at), hn::Load(tag, group.z + at)};
    Lanes n{hn::Load(tag, normals.x + at), hn::Load(tag, normals.y + at), hn::Load(tag, normals.z + at)};
    V height = zero;
    for (int k = 0; k < iterations; ++k) {
      Lanes sum{zero, zero, zero};
      V weights = zero, heights = zero;
      for (const Candidate& c : candidates) {
        const V dx = hn::Sub(Constant(c.x), p.x), dy = hn::Sub(Constant(c.y), p.y), dz = hn::Sub(Constant(c.z), p.z);
        const V d2 = pn::MulAdd(dx, dx, pn::MulAdd(dy, dy, hn::Mul(dz, dz)));
        V factor = zero;
        if (!ByDistance<kFormula>(c, d2, factor)) continue;
        const V z = pn::MulAdd(n.x, dx, pn::MulAdd(n.y, dy, hn::Mul(n.z, dz)));
        V own = zero;
        if constexpr (kFormula == NormalFormula::laguerre) {
          const V s = hn::Min(pn::MulAdd(hn::Mul(z, z), Constant(c.inverse_height), factor), Constant(kFarthest));
          const V polynomial = pn::MulAdd(s, pn::MulAdd(s, Constant(0.5f), Constant(-3.5f)), Constant(4.375f));
          own = hn::Mul(polynomial, pn::Exp(hn::Neg(s)));
        } else {
          const V cosine =
              pn::MulAdd(n.x, Constant(c.nx), pn::MulAdd(n.y, Constant(c.ny), hn::Mul(n.z, Constant(c.nz))));
          // ‖n − n_i‖² = 2 − 2⟨n, n_i⟩
          const V turn = hn::Mul(hn::Sub(one, cosine), Constant(inverse_turn));
          const V exponent = hn::Min(pn::MulAdd(hn::Mul(z, z), Constant(c.inverse_height), turn), Constant(kFarthest));
          const V w = hn::Mul(factor, pn::Exp(hn::Neg(exponent)));
          // The other side of a thin sheet has no weight at any distance.
          own = hn::IfThenElseZero(hn::Gt(cosine, zero), w);
        }
        sum.x = pn::MulAdd(own, Constant(c.nx), sum.x);
        sum.y = pn::MulAdd(own, Constant(c.ny), sum.y);
        sum.z = pn::MulAdd(own, Constant(c.nz), sum.z);
        // ⟨x − x_i, n_i⟩
        const V over = pn::MulAdd(dx, Constant(-c.nx), pn::NegMulAdd(dy, Constant(c.ny), hn::Mul(dz, Constant(-c.nz))));
        weights = hn::Add(weights, own);
        heights = pn::MulAdd(own, over, heights);
      }
      height = hn::Div(heights, hn::Max(weights, Constant(1e-30f)));
      // The polynomial has negative values: where they dominate, no height is known.
      if constexpr (kFormula == NormalFormula::laguerre)
        height = hn::IfThenElseZero(hn::Gt(weights, Constant(1e-3f)), height);
      const V n2 = pn::MulAdd(sum.x, sum.x, pn::MulAdd(sum.y, sum.y, hn::Mul(sum.z, sum.z)));
      auto good = hn::Gt(n2, Constant(1e-36f));
      // The same holds for a normal that they turn to the opposite side.
      if constexpr (kFormula == NormalFormula::laguerre) {
        const V along = pn::MulAdd(sum.x, n.x, pn::MulAdd(sum.y, n.y, hn::Mul(sum.z, n.z)));
        good = hn::And(good, hn::Gt(along, zero));
      }
      const V inverse = hn::Div(one, hn::Sqrt(hn::IfThenElse(good, n2, one)));
      n.x = hn::IfThenElse(good, hn::Mul(sum.x, inverse), n.x);
      n.y = hn::IfThenElse(good, hn::Mul(sum.y, inverse), n.y);
      n.z = hn::IfThenElse(good, hn::Mul(sum.z, inverse), n.z);
    }
    hn::Store(n.x, tag, normals.x + at), hn::Store(n.y, tag, normals.y + at), hn::Store(n.z, tag, normals.z + at);
    hn::Store(height, tag, normals.height + at);
  }
}

void RefineGroup(NormalFormula formula, std::span<const Candidate> candidates, const PointGroup& group, int iterations,
                 float inverse_turn, GroupNormals& normals) {
  using F = NormalFormula;
  if (formula == F::laguerre) return Refine<F::laguerre>(candidates, group, iterations, inverse_turn, normals);
  if (formula == F::bilateral_gaussian)
    return Refine<F::bilateral_gaussian>(candidates, group, iterations, inverse_turn, normals);
  Refine<F::bilateral>(candidates, group, iterations, inverse_turn, normals);
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(RefineGroup);

void refine_group(NormalFormula formula, std::span<const Candidate> candidates, const PointGroup& group, int iterations,
                  float inverse_turn, GroupNormals& normals) {
  HWY_DYNAMIC_DISPATCH(RefineGroup)(formula, candidates, group, iterations, inverse_turn, normals);
}

}  // namespace sansmesh::inline v1::detail
#endif
