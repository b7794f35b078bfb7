#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/surface/foot_kernels.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h (Highway).
#include <hwy/highway.h>

#include "sansmesh/surface/fit_lanes-inl.h"
#include "sansmesh/surface/foot_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {

HWY_INLINE Offset FromFoot(const Paraboloid& f, const Lanes& p) {
  const V x = hn::Sub(p.x, Constant(f.x)), y = hn::Sub(p.y, Constant(f.y)), z = hn::Sub(p.z, Constant(f.z));
  return {x, y, z, pn::MulAdd(x, x, pn::MulAdd(y, y, Times(z, z)))};
}

/// 1 − d²/R², or 0 if that is negative.
HWY_INLINE V Nearness(const Paraboloid& f, const Offset& d) {
  return hn::Max(pn::NegMulAdd(d.square, Constant(f.inverse_support), Constant(1)), hn::Zero(Tag()));
}

/// Normal of the nearest paraboloid.
HWY_INLINE Lanes NearestNormal(std::span<const Paraboloid> near, const Lanes& p) {
  const V zero = hn::Zero(Tag());
  V most = zero;
  Lanes n{zero, zero, zero};
  for (const Paraboloid& f : near) {
    const V t = Nearness(f, FromFoot(f, p));
    const auto nearer = hn::Gt(t, most);
    most = hn::Max(t, most);
    n = {hn::IfThenElse(nearer, Constant(f.nx), n.x), hn::IfThenElse(nearer, Constant(f.ny), n.y),
         hn::IfThenElse(nearer, Constant(f.nz), n.z)};
  }
  return n;
}

void BlendParaboloids(std::span<const Paraboloid> near, const PointGroup& group, bool sheets, GroupHeights& out) {
  const Tag tag;
  const V zero = hn::Zero(tag), one = Constant(1);
  for (std::size_t at = 0; at < kGroup; at += kLanes) {
    if (at >= group.count && at > 0) break;
    const Lanes p = PointsAt(group, at);
    const Lanes facing = sheets ? NearestNormal(near, p) : Lanes{zero, zero, zero};
    V inside = Constant(-1), weight = zero, sum = zero;
    Lanes slope{zero, zero, zero};
    for (const Paraboloid& f : near) {
      const Offset d = FromFoot(f, p);
      V t = Nearness(f, d);
      if (hn::AllFalse(tag, hn::Gt(t, zero))) continue;
      inside = hn::Max(inside, pn::NegMulAdd(d.square, Constant(f.inverse_reach), one));
      const V nx = Constant(f.nx), ny = Constant(f.ny), nz = Constant(f.nz);
      if (sheets) t = hn::IfThenElseZero(hn::Gt(Dot3({nx, ny, nz}, facing), zero), t);
      const V t2 = Times(t, t), w = Times(t2, t2);
      const V bx = pn::MulAdd(Constant(f.xx), d.x, pn::MulAdd(Constant(f.xy), d.y, Times(Constant(f.xz), d.z)));
      const V by = pn::MulAdd(Constant(f.xy), d.x, pn::MulAdd(Constant(f.yy), d.y, Times(Constant(f.yz), d.z)));
      const V bz = pn::MulAdd(Constant(f.xz), d.x, pn::MulAdd(Constant(f.yz), d.y, Times(Constant(f.zz), d.z)));
      const V height = pn::MulAdd(hn::Sub(nx, bx), d.x, pn::MulAdd(hn::Sub(ny, by), d.y, Times(hn::Sub(nz, bz), d.z)));
      weight = hn::Add(weight, w);
      sum = pn::MulAdd(w, height, sum);
      slope = {pn::MulAdd(w, nx, slope.x), pn::MulAdd(w, ny, slope.y), pn::MulAdd(w, nz, slope.z)};
    }
    const auto any = hn::Gt(weight, Constant(kLeast));
    const V inverse = hn::Div(one, hn::IfThenElse(any, weight, one));
    hn::Store(Times(sum, inverse), tag, out.value + at);
    hn::Store(Times(slope.x, inverse), tag, out.x + at);
    hn::Store(Times(slope.y, inverse), tag, out.y + at);
    hn::Store(Times(slope.z, inverse), tag, out.z + at);
    hn::Store(hn::IfThenElse(any, inside, Constant(-1)), tag, out.inside + at);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(BlendParaboloids);

void blend_paraboloids(std::span<const Paraboloid> near, const PointGroup& group, bool sheets, GroupHeights& out) {
  HWY_DYNAMIC_DISPATCH(BlendParaboloids)(near, group, sheets, out);
}

}  // namespace sansmesh::inline v1::detail
#endif
