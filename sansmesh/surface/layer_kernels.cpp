#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/surface/layer_kernels.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h (Highway).
#include <hwy/highway.h>

#include "sansmesh/surface/fit_lanes-inl.h"
#include "sansmesh/surface/layer_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {

/// Rounds of alternating direction and offset. A round of the predictor costs a few products, one of the corrector a
/// sum over the samples.
constexpr int kAlternations = 12, kCorrections = 3;
/// Evaluations of the slope along the normal, and length of the search over the radius of the supports.
constexpr int kSearches = 6;
constexpr float kSearched = 0.25f;

/// Moments of the samples around a point, weighted by the samples' own weights alone; distance only selects them.
struct Moments {
  V weight, inside;
  Lanes first;               // Σ ω (x_i − r)
  Lanes outward;             // Σ ω n_i
  V xx, xy, xz, yy, yz, zz;  // Σ ω (x_i − r)(x_i − r)ᵀ
  V width2;                  // mean h² of the supports
};

/// Weight of a sample whose support contains the point.
HWY_INLINE V Present(const Candidate& c, const Offset& o, bool sheets, const Lanes& near) {
  const auto there = hn::Lt(Times(o.square, Constant(c.inverse_support)), Constant(1));
  const V w = hn::IfThenElseZero(there, Constant(c.weight));
  return sheets ? Times(w, SameSheet(c, near)) : w;
}

HWY_INLINE Moments Gather(std::span<const Candidate> candidates, const Lanes& r, bool sheets, const Lanes& near) {
  const V zero = hn::Zero(Tag());
  Moments m{zero, Constant(-1), {zero, zero, zero}, {zero, zero, zero}, zero, zero, zero, zero, zero, zero, zero};
  for (const Candidate& c : candidates) {
    const Offset o = From(r, c);
    const V w = Present(c, o, sheets, near);
    m.inside = hn::Max(m.inside, pn::NegMulAdd(o.square, Constant(c.inverse_reach), Constant(1)));
    const V ax = Times(w, o.x), ay = Times(w, o.y), az = Times(w, o.z);
    m.weight = hn::Add(m.weight, w);
    m.first = {hn::Add(m.first.x, ax), hn::Add(m.first.y, ay), hn::Add(m.first.z, az)};
    m.outward = {pn::MulAdd(w, Constant(c.nx), m.outward.x), pn::MulAdd(w, Constant(c.ny), m.outward.y),
                 pn::MulAdd(w, Constant(c.nz), m.outward.z)};
    m.xx = pn::MulAdd(ax, o.x, m.xx), m.xy = pn::MulAdd(ax, o.y, m.xy), m.xz = pn::MulAdd(ax, o.z, m.xz);
    m.yy = pn::MulAdd(ay, o.y, m.yy), m.yz = pn::MulAdd(ay, o.z, m.yz), m.zz = pn::MulAdd(az, o.z, m.zz);
    m.width2 = pn::MulAdd(w, Constant(0.25f / c.inverse_support), m.width2);
  }
  m.inside = hn::IfThenElse(hn::Gt(m.weight, zero), m.inside, Constant(-1));
  return m;
}

/// Unit vector of least Σ ω ⟨n, x_i − q⟩², q relative to r.
HWY_INLINE Lanes LeastAxisAbout(const Moments& m, const Lanes& q, const Lanes& start) {
  // Σ ω (d − q)(d − q)ᵀ = second moments − q fᵀ − f qᵀ + W q qᵀ = second moments − q gᵀ − f qᵀ with g = f − W q.
  const Lanes &f = m.first, g{pn::NegMulAdd(m.weight, q.x, f.x), pn::NegMulAdd(m.weight, q.y, f.y),
                              pn::NegMulAdd(m.weight, q.z, f.z)};
  const auto about = [&](const V& second, const V& qi, const V& gj, const V& fi, const V& qj) {
    return pn::NegMulAdd(qi, gj, pn::NegMulAdd(fi, qj, second));
  };
  return LeastAxis(about(m.xx, q.x, g.x, f.x, q.x), about(m.xy, q.x, g.y, f.x, q.y), about(m.xz, q.x, g.z, f.x, q.z),
                   about(m.yy, q.y, g.y, f.y, q.y), about(m.yz, q.y, g.z, f.y, q.z), about(m.zz, q.z, g.z, f.z, q.z),
                   start);
}

/// Plane of least Σ ω ⟨n, x_i − q⟩² over n and q. Alternating (tejada2008): n for q, then q moved along n. Directly:
/// the minimum is known, it passes through the mean.
HWY_INLINE Plane PredictedPlane(const Moments& m, bool alternating) {
  const V zero = hn::Zero(Tag());
  const V inverse = hn::Div(Constant(1), hn::Max(m.weight, Constant(kLeast)));
  const Lanes mean{Times(m.first.x, inverse), Times(m.first.y, inverse), Times(m.first.z, inverse)};
  Lanes n = Unit(m.outward, {zero, zero, Constant(1)});
  const V width2 = Times(m.width2, inverse);
  if (!alternating) {
    n = LeastAxisAbout(m, mean, n);
    return {n, Dot3(n, mean), width2};
  }
  Lanes q{zero, zero, zero};
  for (int k = 0; k < kAlternations; ++k) {
    n = LeastAxisAbout(m, q, n);
    q = Along(q, n, hn::Sub(Dot3(n, mean), Dot3(n, q)));
  }
  return {n, Dot3(n, q), width2};
}

/// g(ξ, η) = A ξ² + B η² + C ξη + D over the plane, about q: the foot is at q + D n.
template <class Weight>
HWY_INLINE void BivariateFoot(std::span<const Candidate> candidates, const Lanes& q, const Plane& plane,
                              const Weight& weight, const V& inside, std::size_t at, GroupFeet& out) {
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
    if (!weight(c, o, w)) continue;
    const Lanes d{o.x, o.y, o.z};
    const V u = Dot3(d, frame.t), v = Dot3(d, frame.b), z = Dot3(d, frame.n);
    const V uu = Times(u, u), vv = Times(v, v), uv = Times(u, v);
    const V w1 = Times(w, uu), w2 = Times(w, vv), w3 = Times(w, uv);
    a[0] = hn::Add(a[0], w), a[1] = hn::Add(a[1], w1), a[3] = hn::Add(a[3], w2), a[6] = hn::Add(a[6], w3);
    a[2] = pn::MulAdd(w1, uu, a[2]), a[4] = pn::MulAdd(w1, vv, a[4]), a[5] = pn::MulAdd(w2, vv, a[5]);
    a[7] = pn::MulAdd(w1, uv, a[7]), a[8] = pn::MulAdd(w2, uv, a[8]), a[9] = pn::MulAdd(w3, uv, a[9]);
    f[0] = pn::MulAdd(w, z, f[0]), f[1] = pn::MulAdd(w1, z, f[1]);
    f[2] = pn::MulAdd(w2, z, f[2]), f[3] = pn::MulAdd(w3, z, f[3]);
  }
  SolveLanes<4>(a, f);
  const V two = Times(Constant(2), unit);
  StoreFoot(Along(q, plane.normal, hn::Div(f[0], unit)), plane.normal, Times(f[1], two), Times(f[3], unit),
            Times(f[2], two), inside, at, out);
}

/// Half the derivative of Σ ω θ(‖x_i − x − t n‖) ⟨n, x_i − x − t n⟩² with respect to t.
HWY_INLINE V SlopeAlong(std::span<const Candidate> candidates, const Lanes& x, const Lanes& n, const V& t, bool sheets,
                        const Lanes& near) {
  const Lanes q = Along(x, n, t);
  V sum = hn::Zero(Tag());
  for (const Candidate& c : candidates) {
    const Offset o = From(q, c);
    V w;
    if (!WeightAt(c, o, sheets, near, w)) continue;
    const V z = Dot3({o.x, o.y, o.z}, n);
    // θ = s⁴ with s = 1 − d²/R²: its derivative with respect to t is 8 s³ z / R².
    const V s = hn::Max(pn::NegMulAdd(o.square, Constant(c.inverse_support), Constant(1)), Constant(1e-6f));
    const V growth = hn::Div(Times(Times(z, z), Constant(4 * c.inverse_support)), s);
    sum = pn::MulAdd(Times(w, z), hn::Sub(growth, Constant(1)), sum);
  }
  return sum;
}

/// Point along the normal where that derivative vanishes, by the secant method that never keeps the same end twice
/// (Illinois). Without a change of sign, the point of the weighted mean.
HWY_INLINE V SearchAlong(std::span<const Candidate> candidates, const Lanes& x, const Plane& plane, bool sheets,
                         const Lanes& near) {
  const V reach = Times(hn::Sqrt(plane.width2), Constant(2 * kSearched));
  V low = hn::Sub(plane.distance, reach), high = hn::Add(plane.distance, reach);
  V at_low = SlopeAlong(candidates, x, plane.normal, low, sheets, near);
  V at_high = SlopeAlong(candidates, x, plane.normal, high, sheets, near);
  const auto bracketed = hn::And(hn::Lt(at_low, hn::Zero(Tag())), hn::Gt(at_high, hn::Zero(Tag())));
  V t = plane.distance;
  for (int k = 0; k < kSearches; ++k) {
    const V slope = SlopeAlong(candidates, x, plane.normal, t, sheets, near);
    const auto beyond = hn::Gt(slope, hn::Zero(Tag()));
    // The value at the kept end is halved, which moves the next secant to its side.
    at_low = hn::IfThenElse(beyond, Times(at_low, Constant(k > 0 ? 0.5f : 1.0f)), slope);
    at_high = hn::IfThenElse(beyond, slope, Times(at_high, Constant(k > 0 ? 0.5f : 1.0f)));
    low = hn::IfThenElse(beyond, low, t), high = hn::IfThenElse(beyond, t, high);
    const V span = hn::Sub(at_high, at_low);
    const V share = hn::Div(hn::Neg(at_low), hn::IfThenElse(hn::Gt(span, Constant(kLeast)), span, Constant(1)));
    t = pn::MulAdd(hn::Min(hn::Max(share, hn::Zero(Tag())), Constant(1)), hn::Sub(high, low), low);
  }
  return hn::IfThenElse(bracketed, t, plane.distance);
}

void ProjectOntoLayer(const LayerKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                      GroupFeet& out) {
  const Tag tag;
  const V zero = hn::Zero(tag);
  for (std::size_t at = 0; at < kGroup; at += kLanes) {
    if (at >= group.count && at > 0) break;
    const Lanes r = PointsAt(group, at);
    Lanes near{zero, zero, zero};
    if (kernel.sheets) near = NearNormals<CompactWeight<false>>(candidates, r);
    Lanes x = r;
    V inside = Constant(1);  // upper bound
    if (kernel.predictor) {
      const Moments m = Gather(candidates, r, kernel.sheets, near);
      inside = m.inside;
      const Plane plane = PredictedPlane(m, kernel.alternating);
      const auto present = [&](const Candidate& c, const Offset&, V& w) {
        w = Present(c, From(r, c), kernel.sheets, near);
        return true;
      };
      BivariateFoot(candidates, Along(r, plane.normal, plane.distance), plane, present, inside, at, out);
      if (!kernel.corrector) continue;
      x = {hn::Load(tag, out.x + at), hn::Load(tag, out.y + at), hn::Load(tag, out.z + at)};
    }
    V reached = inside;
    Plane plane = FitPlane<true>(candidates, x, kernel.sheets, near, &reached);
    inside = hn::Min(inside, reached);  // inside for both the point and its prediction
    Lanes q = Along(x, plane.normal, plane.distance);
    for (int k = 1; k < kCorrections; ++k) {
      plane = PlaneBelow(candidates, q, x, kernel.sheets, near);
      if (kernel.line_search) plane.distance = SearchAlong(candidates, x, plane, kernel.sheets, near);
      q = Along(x, plane.normal, plane.distance);
    }
    const auto by_distance = [&](const Candidate& c, const Offset& o, V& w) {
      return WeightAt(c, o, kernel.sheets, near, w);
    };
    BivariateFoot(candidates, q, plane, by_distance, inside, at, out);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(ProjectOntoLayer);

void project_onto_layer(const LayerKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                        GroupFeet& out) {
  HWY_DYNAMIC_DISPATCH(ProjectOntoLayer)(kernel, candidates, group, out);
}

}  // namespace sansmesh::inline v1::detail
#endif
