#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/surface/projection_kernels.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h (Highway).
#include <hwy/highway.h>

#include "sansmesh/surface/fit_lanes-inl.h"
#include "sansmesh/surface/projection_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {

/// levin2003, alexa2003: a plane, then the weighted least-squares quadratic polynomial over it, about q.
template <bool kGaussian>
HWY_INLINE void QuadraticFoot(std::span<const Candidate> candidates, const Lanes& q, const Plane& plane, bool sheets,
                              const Lanes& near, const V& inside, std::size_t at, GroupFeet& out) {
  const V zero = hn::Zero(Tag());
  Lanes t{zero, zero, zero}, b = t;
  TangentFrame(plane.normal, t, b);
  const V unit = hn::Div(Constant(1), hn::Sqrt(hn::Max(plane.width2, Constant(kLeast))));
  const ScaledFrame frame = Scaled(t, b, plane.normal, unit);
  V a[21], f[6];
  for (V& v : a) v = zero;
  for (V& v : f) v = zero;
  // Moments w uⁱ vʲ; the matrix of the basis 1, u, v, u², uv, v² consists of fifteen of them.
  V m[15];
  for (V& v : m) v = zero;
  for (const Candidate& c : candidates) {
    const Offset o = From(q, c);
    V w;
    if (!WeightAt<kGaussian>(c, o, sheets, near, w)) continue;
    const Lanes d{o.x, o.y, o.z};
    const V u = Dot3(d, frame.t), v = Dot3(d, frame.b), z = Dot3(d, frame.n);
    const V wu = Times(w, u), wv = Times(w, v), wuu = Times(wu, u), wuv = Times(wu, v), wvv = Times(wv, v);
    const V uu = Times(u, u), uv = Times(u, v), vv = Times(v, v);
    m[0] = hn::Add(m[0], w), m[1] = hn::Add(m[1], wu), m[2] = hn::Add(m[2], wv);
    m[3] = hn::Add(m[3], wuu), m[4] = hn::Add(m[4], wuv), m[5] = hn::Add(m[5], wvv);
    m[6] = pn::MulAdd(wuu, u, m[6]), m[7] = pn::MulAdd(wuu, v, m[7]);
    m[8] = pn::MulAdd(wvv, u, m[8]), m[9] = pn::MulAdd(wvv, v, m[9]);
    m[10] = pn::MulAdd(wuu, uu, m[10]), m[11] = pn::MulAdd(wuu, uv, m[11]), m[12] = pn::MulAdd(wuu, vv, m[12]);
    m[13] = pn::MulAdd(wvv, uv, m[13]), m[14] = pn::MulAdd(wvv, vv, m[14]);
    f[0] = pn::MulAdd(w, z, f[0]), f[1] = pn::MulAdd(wu, z, f[1]), f[2] = pn::MulAdd(wv, z, f[2]);
    f[3] = pn::MulAdd(wuu, z, f[3]), f[4] = pn::MulAdd(wuv, z, f[4]), f[5] = pn::MulAdd(wvv, z, f[5]);
  }
  const int map[21] = {0, 1, 3, 2, 4, 5, 3, 6, 7, 10, 4, 7, 8, 11, 12, 5, 8, 9, 12, 13, 14};
  for (int k = 0; k < 21; ++k) a[k] = m[map[k]];
  SolveLanes<6>(a, f);
  const V one = Constant(1);
  const Lanes p = Along(q, plane.normal, hn::Div(f[0], unit));
  // Tangent plane and second derivatives of the polynomial at u = v = 0.
  const V steep = hn::Div(one, hn::Sqrt(pn::MulAdd(f[1], f[1], pn::MulAdd(f[2], f[2], one))));
  const Lanes n = Unit(Along(Along(plane.normal, t, hn::Neg(f[1])), b, hn::Neg(f[2])), plane.normal);
  const V scale = Times(unit, steep);
  const V xx = Times(Times(f[3], Constant(2)), scale), xy = Times(f[4], scale),
          yy = Times(Times(f[5], Constant(2)), scale);
  // The same form in the frame of the new normal.
  Lanes t2{zero, zero, zero}, b2 = t2;
  TangentFrame(n, t2, b2);
  const V tt = Dot3(t, t2), tb = Dot3(t, b2), bt = Dot3(b, t2), bb = Dot3(b, b2);
  const auto form = [&](const V& u1, const V& v1, const V& u2, const V& v2) {
    return pn::MulAdd(Times(u1, u2), xx, pn::MulAdd(pn::MulAdd(u1, v2, Times(u2, v1)), xy, Times(Times(v1, v2), yy)));
  };
  StoreFoot(p, n, form(tt, bt, tt, bt), form(tt, bt, tb, bb), form(tb, bb, tb, bb), inside, at, out);
}

/// tejada2008, 4.2: the mean plane, then directional curvatures κ_i = 2 z_i / ρ_i² about q. In terms of the heights z_i
/// the fit of χ₁ + χ₂ cos 2θ + χ₃ sin 2θ to κ_i with weights ρ^{2τ} exp(−ρ²/h²) is a fit of δ + ½ χ₁ ρ² + ½ χ₂ (u² −
/// v²) + χ₃ u v to z_i with weights ρ^{2τ−4} exp(−ρ²/h²), without angles. The offset δ replaces the fixed point of the
/// diffusion, where the anisotropic mean of the heights, without the part due to curvature, vanishes.
template <bool kGaussian, int kTau, bool kDiffusion>
HWY_INLINE void CurvatureFoot(std::span<const Candidate> candidates, const ProjectionKernel& kernel, const Lanes& q,
                              const Plane& plane, const Lanes& near, const V& inside, std::size_t at, GroupFeet& out) {
  const V zero = hn::Zero(Tag()), one = Constant(1);
  Lanes t{zero, zero, zero}, b = t;
  TangentFrame(plane.normal, t, b);
  const V unit = hn::Div(one, hn::Sqrt(hn::Max(plane.width2, Constant(kLeast))));  // unit of length: h
  const ScaledFrame frame = Scaled(t, b, plane.normal, unit);
  V a[10], f[4];
  for (V& v : a) v = zero;
  for (V& v : f) v = zero;
  for (const Candidate& c : candidates) {
    const Offset o = From(q, c);
    V w;
    if (!WeightAt<kGaussian>(c, o, kernel.sheets, near, w)) continue;
    const Lanes d{o.x, o.y, o.z};
    const V u = Dot3(d, frame.t), v = Dot3(d, frame.b), z = Dot3(d, frame.n);
    const V uu = Times(u, u), vv = Times(v, v);
    const V r2 = hn::Add(uu, vv);
    if constexpr (kDiffusion) {
      // |κ| = 2 |z| / ρ², where ρ is the distance of the sample, which does not vanish off the plane.
      const V far = pn::MulAdd(z, z, r2);
      const V excess =
          hn::Sub(hn::Div(hn::Abs(hn::Add(z, z)), hn::Max(far, Constant(1e-6f))), Constant(kernel.threshold));
      const V lambda2 = Constant(kernel.threshold * kernel.threshold);
      const V beyond = hn::Max(excess, zero);
      if (kernel.hard)
        w = hn::IfThenZeroElse(hn::Gt(excess, zero), w);
      else
        w = Times(w, hn::Div(lambda2, pn::MulAdd(Times(beyond, beyond), Constant(10), lambda2)));
    }
    if constexpr (kTau == 1) w = hn::Div(w, hn::Max(r2, Constant(1e-2f)));
    if constexpr (kTau == 3) w = Times(w, r2);
    const V p1 = Times(r2, Constant(0.5f)), p2 = Times(hn::Sub(uu, vv), Constant(0.5f)), p3 = Times(u, v);
    const V w1 = Times(w, p1), w2 = Times(w, p2), w3 = Times(w, p3);
    a[0] = hn::Add(a[0], w), a[1] = hn::Add(a[1], w1), a[3] = hn::Add(a[3], w2), a[6] = hn::Add(a[6], w3);
    a[2] = pn::MulAdd(w1, p1, a[2]), a[4] = pn::MulAdd(w1, p2, a[4]), a[5] = pn::MulAdd(w2, p2, a[5]);
    a[7] = pn::MulAdd(w1, p3, a[7]), a[8] = pn::MulAdd(w2, p3, a[8]), a[9] = pn::MulAdd(w3, p3, a[9]);
    f[0] = pn::MulAdd(w, z, f[0]), f[1] = pn::MulAdd(w1, z, f[1]);
    f[2] = pn::MulAdd(w2, z, f[2]), f[3] = pn::MulAdd(w3, z, f[3]);
  }
  SolveLanes<4>(a, f);
  const Lanes p = Along(q, plane.normal, hn::Div(f[0], unit));
  StoreFoot(p, plane.normal, Times(hn::Add(f[1], f[2]), unit), Times(f[3], unit), Times(hn::Sub(f[1], f[2]), unit),
            inside, at, out);
}

template <bool kGaussian>
void Project(const ProjectionKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
             GroupFeet& out) {
  const V zero = hn::Zero(Tag());
  for (std::size_t at = 0; at < kGroup; at += kLanes) {
    if (at >= group.count && at > 0) break;
    const Lanes r = PointsAt(group, at);
    Lanes near{zero, zero, zero};
    if (kernel.sheets)
      near = NearNormals<std::conditional_t<kGaussian, GaussianWeight<false>, CompactWeight<false>>>(candidates, r);
    V inside;
    if (kernel.method == ProjectionMethod::curvature) {
      const Plane plane = FitPlane<false, kGaussian>(candidates, r, kernel.sheets, near, &inside);
      const Lanes q = Along(r, plane.normal, plane.distance);
      const auto foot = [&](auto tau) {
        if (kernel.diffusion)
          CurvatureFoot<kGaussian, decltype(tau)::value, true>(candidates, kernel, q, plane, near, inside, at, out);
        else
          CurvatureFoot<kGaussian, decltype(tau)::value, false>(candidates, kernel, q, plane, near, inside, at, out);
      };
      if (kernel.tau == 1)
        foot(std::integral_constant<int, 1>());
      else if (kernel.tau == 3)
        foot(std::integral_constant<int, 3>());
      else
        foot(std::integral_constant<int, 2>());
      continue;
    }
    Plane plane = FitPlane<true, kGaussian>(candidates, r, kernel.sheets, near, &inside);
    Lanes q = Along(r, plane.normal, plane.distance);
    // alexa2003 uses weights about r. Levin's plane is the minimum over direction and offset, with weights about its
    // own foot q: a fixed point of the same step with r = q, for which q stays on the line through r.
    if (kernel.method == ProjectionMethod::levin) {
      for (int k = 0; k < kLevinSteps; ++k) {
        plane = PlaneBelow<kGaussian>(candidates, q, r, kernel.sheets, near);
        q = Along(r, plane.normal, plane.distance);
      }
    }
    QuadraticFoot<kGaussian>(candidates, q, plane, kernel.sheets, near, inside, at, out);
  }
}

void ProjectGroup(const ProjectionKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                  GroupFeet& out) {
  if (kernel.gaussian) return Project<true>(kernel, candidates, group, out);
  Project<false>(kernel, candidates, group, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(ProjectGroup);

void project_group(const ProjectionKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                   GroupFeet& out) {
  HWY_DYNAMIC_DISPATCH(ProjectGroup)(kernel, candidates, group, out);
}

}  // namespace sansmesh::inline v1::detail
#endif
