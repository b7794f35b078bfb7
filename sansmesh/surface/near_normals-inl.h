// Weights, and the selection of samples on the sheet next to a point: shared by all kernels. Included once for each
// instruction set.
#if defined(SANSMESH_SURFACE_NEAR_NORMALS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SANSMESH_SURFACE_NEAR_NORMALS_INL_H_
#undef SANSMESH_SURFACE_NEAR_NORMALS_INL_H_
#else
#define SANSMESH_SURFACE_NEAR_NORMALS_INL_H_
#endif

#include <span>

#include "sansmesh/surface/numbers-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {

/// One vector per lane.
struct Lanes {
  V x, y, z;
};

/// Weights (1 − d²/R²)⁴ of compact support: similar to exp(−d²/h²) for R = 2h.
template <bool kGradient>
struct CompactWeight {
  HWY_INLINE static bool Evaluate(const Candidate& c, const V& d2, const V& dx, const V& dy, const V& dz,
                                  Num<kGradient>& w) {
    const V a = Constant(c.inverse_support);
    const V t = hn::Max(pn::NegMulAdd(d2, a, Constant(1)), hn::Zero(Tag()));
    if (hn::AllFalse(Tag(), hn::Gt(t, hn::Zero(Tag())))) return false;
    const V t2 = hn::Mul(t, t), t3 = hn::Mul(t2, t);
    const V derivative = hn::Mul(t3, Constant(-4 * c.weight * c.inverse_support));
    w = Radial(hn::Mul(hn::Mul(t2, t2), Constant(c.weight)), derivative, dx, dy, dz,
               static_cast<const Num<kGradient>*>(nullptr));
    return true;
  }
};

/// exp(−ε d²/h²), cut off at exp(−kGaussianEnd).
template <bool kGradient>
struct GaussianWeight {
  HWY_INLINE static bool Evaluate(const Candidate& c, const V& d2, const V& dx, const V& dy, const V& dz,
                                  Num<kGradient>& w) {
    const V r = hn::Mul(d2, Constant(c.inverse_support));
    const auto near = hn::Lt(r, Constant(kGaussianEnd));
    if (hn::AllFalse(Tag(), near)) return false;
    const V e = hn::IfThenElseZero(near, hn::Mul(pn::Exp(hn::Neg(r)), Constant(c.weight)));
    w = Radial(e, hn::Mul(e, Constant(-c.inverse_support)), dx, dy, dz, static_cast<const Num<kGradient>*>(nullptr));
    return true;
  }
};

/// Direction of the surface next to the points: means of normals with weights of half the width. Where these disagree,
/// between two sheets, the nearest sample decides.
template <class Weight>
HWY_INLINE Lanes NearNormals(std::span<const Candidate> candidates, const Lanes& p) {
  constexpr float kClear = 0.25f;  // least squared length of the mean that identifies one sheet
  const Tag tag;
  const V zero = hn::Zero(tag);
  Lanes n{zero, zero, zero}, nearest{zero, zero, zero};
  V sum = zero, largest = zero;
  for (const Candidate& c : candidates) {
    const V dx = hn::Sub(p.x, Constant(c.x)), dy = hn::Sub(p.y, Constant(c.y)), dz = hn::Sub(p.z, Constant(c.z));
    const V d2 = pn::MulAdd(dx, dx, pn::MulAdd(dy, dy, hn::Mul(dz, dz)));
    Value w{zero};
    if (!Weight::Evaluate(c, d2, dx, dy, dz, w)) continue;
    // The fourth power, scaled so that small ones do not vanish.
    V narrow = hn::Mul(w.v, Constant(1e4f / c.weight));
    narrow = hn::Mul(narrow, narrow);
    narrow = hn::Mul(hn::Mul(narrow, narrow), Constant(c.weight));
    const V nx = Constant(c.nx), ny = Constant(c.ny), nz = Constant(c.nz);
    n.x = pn::MulAdd(narrow, nx, n.x), n.y = pn::MulAdd(narrow, ny, n.y), n.z = pn::MulAdd(narrow, nz, n.z);
    sum = hn::Add(sum, narrow);
    const auto best = hn::Gt(narrow, largest);
    largest = hn::Max(narrow, largest);
    nearest = {hn::IfThenElse(best, nx, nearest.x), hn::IfThenElse(best, ny, nearest.y),
               hn::IfThenElse(best, nz, nearest.z)};
  }
  const V share = hn::Div(Constant(1), hn::Max(sum, Constant(1e-30f)));
  n = {hn::Mul(n.x, share), hn::Mul(n.y, share), hn::Mul(n.z, share)};
  const V n2 = pn::MulAdd(n.x, n.x, pn::MulAdd(n.y, n.y, hn::Mul(n.z, n.z)));
  const auto clear = hn::Gt(n2, Constant(kClear));
  const V inverse = hn::Div(Constant(1), hn::Sqrt(hn::IfThenElse(clear, n2, Constant(1))));
  return {hn::IfThenElse(clear, hn::Mul(n.x, inverse), nearest.x),
          hn::IfThenElse(clear, hn::Mul(n.y, inverse), nearest.y),
          hn::IfThenElse(clear, hn::Mul(n.z, inverse), nearest.z)};
}

/// 1 for samples whose normals differ by up to 90°, decreasing to 0 at 120°.
HWY_INLINE V SameSheet(const Candidate& c, const Lanes& n) {
  const V cosine = pn::MulAdd(n.x, Constant(c.nx), pn::MulAdd(n.y, Constant(c.ny), hn::Mul(n.z, Constant(c.nz))));
  return hn::Min(hn::Max(pn::MulAdd(cosine, Constant(2), Constant(1)), hn::Zero(Tag())), Constant(1));
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#endif
