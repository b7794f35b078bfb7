#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/surface/bilateral_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway requires.
#include <hwy/highway.h>

#include "sansmesh/surface/bilateral_kernels.h"
#include "sansmesh/surface/near_normals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::detail {
namespace HWY_NAMESPACE {

constexpr float kFarthest = 60;  // exponent beyond which exp() is nothing

void RefineGroup(std::span<const Candidate> candidates, const PointGroup& group, int iterations, float inverse_turn,
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
        const V t = hn::Max(pn::NegMulAdd(d2, Constant(c.inverse_support), one), zero);
        if (hn::AllFalse(tag, hn::Gt(t, zero))) continue;
        const V t2 = hn::Mul(t, t);
        const V z = pn::MulAdd(n.x, dx, pn::MulAdd(n.y, dy, hn::Mul(n.z, dz)));
        const V cosine = pn::MulAdd(n.x, Constant(c.nx), pn::MulAdd(n.y, Constant(c.ny), hn::Mul(n.z, Constant(c.nz))));
        // ‖n − n_i‖² = 2 − 2⟨n, n_i⟩
        const V turn = hn::Mul(hn::Sub(one, cosine), Constant(inverse_turn));
        const V exponent = hn::Min(pn::MulAdd(hn::Mul(z, z), Constant(c.inverse_height), turn), Constant(kFarthest));
        const V w = hn::Mul(hn::Mul(hn::Mul(t2, t2), Constant(c.weight)), pn::Exp(hn::Neg(exponent)));
        // The other side of a thin sheet does not count, whatever its distance.
        const V own = hn::IfThenElseZero(hn::Gt(cosine, zero), w);
        sum.x = pn::MulAdd(own, Constant(c.nx), sum.x);
        sum.y = pn::MulAdd(own, Constant(c.ny), sum.y);
        sum.z = pn::MulAdd(own, Constant(c.nz), sum.z);
        // ⟨x − x_i, n_i⟩
        const V over = pn::MulAdd(dx, Constant(-c.nx), pn::NegMulAdd(dy, Constant(c.ny), hn::Mul(dz, Constant(-c.nz))));
        weights = hn::Add(weights, own);
        heights = pn::MulAdd(own, over, heights);
      }
      height = hn::Div(heights, hn::Max(weights, Constant(1e-30f)));
      const V n2 = pn::MulAdd(sum.x, sum.x, pn::MulAdd(sum.y, sum.y, hn::Mul(sum.z, sum.z)));
      const auto good = hn::Gt(n2, Constant(1e-36f));
      const V inverse = hn::Div(one, hn::Sqrt(hn::IfThenElse(good, n2, one)));
      n.x = hn::IfThenElse(good, hn::Mul(sum.x, inverse), n.x);
      n.y = hn::IfThenElse(good, hn::Mul(sum.y, inverse), n.y);
      n.z = hn::IfThenElse(good, hn::Mul(sum.z, inverse), n.z);
    }
    hn::Store(n.x, tag, normals.x + at), hn::Store(n.y, tag, normals.y + at), hn::Store(n.z, tag, normals.z + at);
    hn::Store(height, tag, normals.height + at);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::detail {
HWY_EXPORT(RefineGroup);

void refine_group(std::span<const Candidate> candidates, const PointGroup& group, int iterations, float inverse_turn,
                  GroupNormals& normals) {
  HWY_DYNAMIC_DISPATCH(RefineGroup)(candidates, group, iterations, inverse_turn, normals);
}

}  // namespace sansmesh::detail
#endif
