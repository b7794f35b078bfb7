#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/surface/implicit_kernels.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h (Highway).
#include <hwy/highway.h>

#include "sansmesh/surface/fit_lanes-inl.h"
#include "sansmesh/surface/implicit_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {

/// Smallest divisor of squares.
constexpr float kTiny = 1e-30f;

/// Weighted moments of the samples: the arguments of all formulas.
template <bool kGradient>
struct Sums {
  Num<kGradient> w, plane, square, inverse_height;
  Num3<kGradient> x, n;
  Num<kGradient> plane_m;  // weighted by the generating functions
  Num3<kGradient> m;
  Num<kGradient> xx, xy, xz, yy, yz, zz;  // second moments about the point
};

template <bool kGradient>
HWY_INLINE Num<kGradient> MeanPlane(const Sums<kGradient>& s, const Num3<kGradient>& p) {
  return (Dot(p, s.n) - s.plane) / s.w;
}

/// adamson2003: distance from the weighted mean of the samples along the weighted mean of their normals.
template <bool kGradient>
HWY_INLINE Num<kGradient> Adamson(const Sums<kGradient>& s, const Num3<kGradient>& p) {
  const Num<kGradient> length = Root(Dot(s.n, s.n) + Constant(kTiny));
  return (Dot(p, s.n) - Dot(s.x, s.n) / s.w) / length;
}

/// Calls `use` with each derivative of a number; never for numbers without derivatives.
template <class Use>
HWY_INLINE void ForEachDerivative(const Use& use) {
  use([](const Dual& a) -> const V& { return a.x; }, [](Dual& a) -> V& { return a.x; });
  use([](const Dual& a) -> const V& { return a.y; }, [](Dual& a) -> V& { return a.y; });
  use([](const Dual& a) -> const V& { return a.z; }, [](Dual& a) -> V& { return a.z; });
}

/// adamson2003 (tejada2008, ch. 2): the direction n of least weighted covariance Σ w ⟨n, x_i − x⟩² / Σ w, on the side
/// of the mean normal. Its derivative along dC is that of the eigenvector: (λ − C) dn = dC n across n.
template <bool kGradient>
HWY_INLINE Num3<kGradient> LeastCovariance(const Sums<kGradient>& s) {
  const V zero = hn::Zero(Tag());
  const Lanes facing = Unit({s.n.x.v, s.n.y.v, s.n.z.v}, {zero, zero, Constant(1)});
  // Lengths in widths, so that fourth powers stay in the range of floats.
  const V trace = hn::Add(s.xx.v, hn::Add(s.yy.v, s.zz.v));
  const V scale = hn::Div(Constant(1), hn::Max(trace, Constant(kTiny)));
  const auto scaled = [&](const V& a) { return Times(a, scale); };
  const V xx = scaled(s.xx.v), xy = scaled(s.xy.v), xz = scaled(s.xz.v), yy = scaled(s.yy.v), yz = scaled(s.yz.v),
          zz = scaled(s.zz.v);
  const Lanes n = LeastEigenvector(xx, xy, xz, yy, yz, zz, facing);
  using N = Num<kGradient>;
  constexpr const N* kTag = nullptr;
  Num3<kGradient> result{Number(n.x, kTag), Number(n.y, kTag), Number(n.z, kTag)};
  if constexpr (kGradient) {
    Lanes t{zero, zero, zero}, b = t;
    TangentFrame(n, t, b);
    const auto times = [](const V& axx, const V& axy, const V& axz, const V& ayy, const V& ayz, const V& azz,
                          const Lanes& a) {
      return Lanes{pn::MulAdd(axx, a.x, pn::MulAdd(axy, a.y, Times(axz, a.z))),
                   pn::MulAdd(axy, a.x, pn::MulAdd(ayy, a.y, Times(ayz, a.z))),
                   pn::MulAdd(axz, a.x, pn::MulAdd(ayz, a.y, Times(azz, a.z)))};
    };
    const Lanes ct = times(xx, xy, xz, yy, yz, zz, t), cb = times(xx, xy, xz, yy, yz, zz, b);
    const V least = Dot3(n, times(xx, xy, xz, yy, yz, zz, n));
    const V tt = hn::Sub(Dot3(t, ct), least), tb = Dot3(t, cb), bb = hn::Sub(Dot3(b, cb), least);
    // If two directions are equally good, the normal jumps and has no derivative.
    const V determinant = pn::NegMulAdd(tb, tb, Times(tt, bb));
    const auto clear = hn::Gt(determinant, Constant(1e-7f));
    const V inverse = hn::IfThenElseZero(clear, hn::Div(Constant(-1), hn::IfThenElse(clear, determinant, Constant(1))));
    ForEachDerivative([&](const auto& of, const auto& set) {
      const Lanes dn = times(scaled(of(s.xx)), scaled(of(s.xy)), scaled(of(s.xz)), scaled(of(s.yy)), scaled(of(s.yz)),
                             scaled(of(s.zz)), n);
      const V f = Times(Dot3(t, dn), inverse), g = Times(Dot3(b, dn), inverse);
      const V u = pn::NegMulAdd(tb, g, Times(bb, f)), v = pn::NegMulAdd(tb, f, Times(tt, g));
      set(result.x) = pn::MulAdd(u, t.x, Times(v, b.x));
      set(result.y) = pn::MulAdd(u, t.y, Times(v, b.y));
      set(result.z) = pn::MulAdd(u, t.z, Times(v, b.z));
    });
  }
  return result;
}

/// guennebaud2007: distance from the algebraic sphere that fits positions and normals (closed form of guennebaud2008, β
/// = 1).
template <bool kGradient>
HWY_INLINE Num<kGradient> AlgebraicSphere(const Sums<kGradient>& s, const Num3<kGradient>& p) {
  using N = Num<kGradient>;
  const N spread = s.square - Dot(s.x, s.x) / s.w;
  const N twist = s.plane - Dot(s.x, s.n) / s.w;
  // The spread of a single sample, or of coincident ones, is only rounding: the sphere becomes a plane.
  const auto flat = hn::Le(spread.v, pn::MulAdd(s.square.v, Constant(1e-5f), Constant(kTiny)));
  const N u4 = Select(flat, Fixed<kGradient>(0), twist / Select(flat, Fixed<kGradient>(1), spread) * Constant(0.5f));
  const N two = u4 + u4;
  const Num3<kGradient> u{(s.n.x - two * s.x.x) / s.w, (s.n.y - two * s.x.y) / s.w, (s.n.z - two * s.x.z) / s.w};
  const N u0 = (Dot(u, s.x) + u4 * s.square) / s.w * Constant(-1);
  const N algebraic = u0 + Dot(u, p) + u4 * Dot(p, p);
  const Num3<kGradient> g{u.x + two * p.x, u.y + two * p.y, u.z + two * p.z};
  // The root is constant on one sphere: 2 |u4| times its radius.
  const N g2 = Dot(g, g);
  N pratt = g2 - two * (algebraic + algebraic);
  pratt = Select(hn::Gt(pratt.v, Constant(kTiny)), pratt, Fixed<kGradient>(kTiny));
  return (algebraic + algebraic) / (Root(g2 + Constant(kTiny)) + Root(pratt));
}

/// Uses the formula where the mean of the tangent planes is near zero, and farther out that mean, because formulas of
/// higher order change their signs again there.
template <bool kGradient>
HWY_INLINE Num<kGradient> NearSurface(const Num<kGradient>& f, const Num<kGradient>& mean, const Sums<kGradient>& s) {
  constexpr float kFull = 0.2f, kNone = 0.6f;  // squares of the distance over the thickness of the domain
  using N = Num<kGradient>;
  const N zero = Fixed<kGradient>(0), one = Fixed<kGradient>(1);
  N t = (mean * mean * s.inverse_height / s.w + Constant(-kNone)) * Constant(-1 / (kNone - kFull));
  t = Select(hn::Gt(t.v, zero.v), t, zero);
  t = Select(hn::Lt(t.v, one.v), t, one);
  const N share = t * t * (Fixed<kGradient>(3) - t - t);
  return mean + share * (f - mean);
}

/// Contribution of the samples of another sheet, which SameSheet excludes.
struct OtherSheet {
  V w, plane;
  Lanes x, n, own;  // own: mean position of this sheet's samples, relative to which the other sheet is located
};

/// Two sheets with the solid between them bound an intersection of half-spaces; with a gap between them, a union. Each
/// sheet alone would continue beyond the edge where they meet.
template <bool kGradient>
HWY_INLINE Num<kGradient> Combine(const Num<kGradient>& f, const Num3<kGradient>& p, const Sums<kGradient>& s,
                                  const OtherSheet& o) {
  constexpr float kShare = 0.03f;  // least share of the weights that makes a sheet
  constexpr float kApart = 0.1f;   // least squared distance of two sheets over the thickness of the domain
  using N = Num<kGradient>;
  const auto enough = hn::Gt(o.w, hn::Mul(s.w.v, Constant(kShare)));
  if (hn::AllFalse(Tag(), enough)) return f;
  const V one = Constant(1);
  const V share = hn::Div(one, hn::IfThenElse(enough, o.w, one)), own = hn::Div(one, s.w.v);
  const auto toward = [&](const V& other, const V& mine, const V& n) {
    return hn::Mul(hn::Sub(hn::Mul(other, share), hn::Mul(mine, own)), n);
  };
  const V length2 = pn::MulAdd(s.n.x.v, s.n.x.v, pn::MulAdd(s.n.y.v, s.n.y.v, hn::Mul(s.n.z.v, s.n.z.v)));
  const V along = hn::Add(toward(o.x.x, o.own.x, s.n.x.v),
                          hn::Add(toward(o.x.y, o.own.y, s.n.y.v), toward(o.x.z, o.own.z, s.n.z.v)));
  const V apart2 = hn::Mul(hn::Mul(along, along), hn::Mul(s.inverse_height.v, own));
  const auto valid = hn::And(enough, hn::Gt(apart2, hn::Mul(length2, Constant(kApart))));
  // The other sheet's weights are treated as constant.
  const N other = (p.x * o.n.x + p.y * o.n.y + p.z * o.n.z + hn::Neg(o.plane)) * share;
  const auto convex = hn::Lt(along, hn::Zero(Tag()));
  const auto larger = hn::Gt(other.v, f.v);
  const auto takes = hn::Or(hn::And(convex, larger), hn::AndNot(convex, hn::Not(larger)));
  return Select(hn::And(valid, takes), other, f);
}

/// Laguerre polynomial of the generating function (mazya2001, three variables) and its derivative.
template <int kOrder>
HWY_INLINE void Laguerre(const V& r, V& value, V& derivative) {
  if constexpr (kOrder == 2) {
    value = Constant(1), derivative = hn::Zero(Tag());
  } else if constexpr (kOrder == 4) {
    value = hn::Sub(Constant(2.5f), r), derivative = Constant(-1);
  } else {
    value = pn::MulAdd(r, pn::MulAdd(r, Constant(0.5f), Constant(-3.5f)), Constant(4.375f));
    derivative = hn::Sub(r, Constant(3.5f));
  }
}
/// Sum of the generating functions over a plane, relative to the Gaussians alone.
constexpr float LaguerreMean(int order) { return order == 2 ? 1.0f : order == 4 ? 1.5f : 1.875f; }

HWY_INLINE void AddScaled(Lanes& sum, const V& weight, float x, float y, float z) {
  sum.x = pn::MulAdd(weight, Constant(x), sum.x);
  sum.y = pn::MulAdd(weight, Constant(y), sum.y);
  sum.z = pn::MulAdd(weight, Constant(z), sum.z);
}
/// Adds a sample's share that belongs to another sheet.
HWY_INLINE void AddSample(const Candidate& c, const V& rest, const V& own, OtherSheet& other) {
  other.w = hn::Add(other.w, rest);
  other.plane = pn::MulAdd(rest, Constant(c.plane), other.plane);
  AddScaled(other.x, rest, c.x, c.y, c.z);
  AddScaled(other.n, rest, c.nx, c.ny, c.nz);
  AddScaled(other.own, own, c.x, c.y, c.z);
}

/// Tangent plane of the nearest sample (hoppe1992).
template <bool kGradient>
struct NearestPlane {
  V nearest;  ///< squared distance
  Num<kGradient> plane;

  HWY_INLINE void Add(const Candidate& c, const V& d2, const V& dx, const V& dy, const V& dz, const V& same,
                      const V& weight) {
    const V far = hn::Div(d2, hn::Max(same, Constant(1e-3f)));
    // Samples are visited because they reach some point of the vector, not necessarily this one.
    const auto closer = hn::And(hn::Lt(far, nearest), hn::Gt(weight, hn::Zero(Tag())));
    nearest = hn::IfThenElse(closer, far, nearest);
    const V height = pn::MulAdd(dx, Constant(c.nx), pn::MulAdd(dy, Constant(c.ny), hn::Mul(dz, Constant(c.nz))));
    Num<kGradient> own = Number(height, static_cast<const Num<kGradient>*>(nullptr));
    if constexpr (kGradient) own.x = Constant(c.nx), own.y = Constant(c.ny), own.z = Constant(c.nz);
    plane = Select(closer, own, plane);
  }
};

/// Second pass of amenta2004: ½⟨n, ∇e⟩ with e the weighted mean of the squared distances along n. For their sum, as in
/// the source, points where the weights decrease fastest are extrema as well: at 0.8 widths from the surface, and as
/// near as that to it where noise puts samples on either side.
template <bool kGaussian, bool kGradient>
HWY_INLINE Num<kGradient> Extremal(std::span<const Candidate> candidates, const Lanes& p, const Num3<kGradient>& point,
                                   const Sums<kGradient>& s, bool sheets, const Lanes& near) {
  using N = Num<kGradient>;
  constexpr const N* kTag = nullptr;
  const N length = Root(Dot(s.n, s.n) + Constant(kTiny));
  const Num3<kGradient> n{s.n.x / length, s.n.y / length, s.n.z / length};
  N slope = Fixed<kGradient>(0), square = slope, pull = slope;
  for (const Candidate& c : candidates) {
    const V dx = hn::Sub(p.x, Constant(c.x)), dy = hn::Sub(p.y, Constant(c.y)), dz = hn::Sub(p.z, Constant(c.z));
    const V d2 = pn::MulAdd(dx, dx, pn::MulAdd(dy, dy, hn::Mul(dz, dz)));
    const Num3<kGradient> d{point.x + Constant(-c.x), point.y + Constant(-c.y), point.z + Constant(-c.z)};
    const N distance = Dot(n, d);
    N w4 = Fixed<kGradient>(0), falls = w4;  // falls: −½⟨n, ∇w⟩
    if constexpr (kGaussian) {
      if (!GaussianWeight<kGradient>::Evaluate(c, d2, dx, dy, dz, w4)) continue;
      if (sheets) w4 = w4 * SameSheet(c, near);
      falls = distance * w4 * Constant(c.inverse_support);
    } else {
      const V a = Constant(c.inverse_support);
      const V t = hn::Max(pn::NegMulAdd(d2, a, Constant(1)), hn::Zero(Tag()));
      if (hn::AllFalse(Tag(), hn::Gt(t, hn::Zero(Tag())))) continue;
      V factor = Constant(c.weight);
      if (sheets) factor = hn::Mul(factor, SameSheet(c, near));
      const V t2 = hn::Mul(t, t), t3 = hn::Mul(hn::Mul(t2, t), factor);
      const N w3 = Radial(t3, hn::Mul(hn::Mul(t2, factor), Constant(-3 * c.inverse_support)), dx, dy, dz, kTag);
      w4 = Radial(hn::Mul(t3, t), hn::Mul(t3, Constant(-4 * c.inverse_support)), dx, dy, dz, kTag);
      falls = distance * w3 * Constant(4 * c.inverse_support);
    }
    slope = slope + distance * (w4 - distance * falls);
    square = square + distance * distance * w4;
    pull = pull + falls;
  }
  return (slope + square / s.w * pull) / s.w;
}

template <bool kGradient>
HWY_INLINE void StoreGradient(const Num<kGradient>& f, std::size_t at, GroupValues& out) {
  hn::Store(f.v, Tag(), out.value + at);
  if constexpr (kGradient) {
    hn::Store(f.x, Tag(), out.x + at);
    hn::Store(f.y, Tag(), out.y + at);
    hn::Store(f.z, Tag(), out.z + at);
  }
}

template <bool kGradient>
HWY_INLINE void AddCovariance(const Candidate& c, const Num<kGradient>& w, const Num3<kGradient>& point,
                              Sums<kGradient>& s) {
  const Num<kGradient> u = point.x + Constant(-c.x), v = point.y + Constant(-c.y), z = point.z + Constant(-c.z);
  const Num<kGradient> wu = w * u, wv = w * v;
  s.xx = s.xx + wu * u, s.xy = s.xy + wu * v, s.xz = s.xz + wu * z;
  s.yy = s.yy + wv * v, s.yz = s.yz + wv * z, s.zz = s.zz + w * z * z;
}

/// Value of the formulas that need no second pass; `mean` for others.
template <ImplicitFormula kFormula, int kOrder, bool kGradient>
HWY_INLINE Num<kGradient> FromSums(const Sums<kGradient>& s, const Num3<kGradient>& point, const Num<kGradient>& mean) {
  if constexpr (kFormula == ImplicitFormula::adamson) return Adamson(s, point);
  if constexpr (kFormula == ImplicitFormula::adamson_covariance) {
    const Num3<kGradient> n = LeastCovariance(s);
    return Dot(point, n) - Dot(s.x, n) / s.w;
  }
  if constexpr (kFormula == ImplicitFormula::apss) return AlgebraicSphere(s, point);
  if constexpr (kFormula == ImplicitFormula::amls)
    return (Dot(point, s.m) - s.plane_m) / s.w * Constant(1 / LaguerreMean(kOrder));
  return mean;
}

template <ImplicitFormula kFormula, int kOrder, bool kGaussian, bool kGradient, bool kNormals = false>
void Evaluate(const ImplicitKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
              GroupValues& out) {
  using N = Num<kGradient>;
  constexpr const N* kTag = nullptr;
  using Weight = std::conditional_t<kGaussian, GaussianWeight<kGradient>, CompactWeight<kGradient>>;
  using PlainWeight = std::conditional_t<kGaussian, GaussianWeight<false>, CompactWeight<false>>;
  constexpr bool kCovariance = kFormula == ImplicitFormula::adamson_covariance;
  constexpr bool kPositions = kFormula == ImplicitFormula::adamson || kFormula == ImplicitFormula::apss || kCovariance;
  const Tag tag;
  const V zero = hn::Zero(tag), one = Constant(1);
  for (std::size_t at = 0; at < kGroup; at += kLanes) {
    if (at >= group.count && at > 0) break;
    const Lanes p{hn::Load(tag, group.x + at), hn::Load(tag, group.y + at), hn::Load(tag, group.z + at)};
    const Num3<kGradient> point = Coordinates(p.x, p.y, p.z, kTag);
    Lanes near{zero, zero, zero};
    if (kernel.sheets) near = NearNormals<PlainWeight>(candidates, p);

    const N nought = Fixed<kGradient>(0);
    const Num3<kGradient> nought3 = Zero3<kGradient>();
    Sums<kGradient> s{nought,  nought, nought, nought, nought3, nought3, nought,
                      nought3, nought, nought, nought, nought,  nought,  nought};
    OtherSheet other{zero, zero, {zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
    V inside = Constant(-1);
    NearestPlane<kGradient> nearest{Constant(1e30f), nought};
    for (const Candidate& c : candidates) {
      const V dx = hn::Sub(p.x, Constant(c.x)), dy = hn::Sub(p.y, Constant(c.y)), dz = hn::Sub(p.z, Constant(c.z));
      const V d2 = pn::MulAdd(dx, dx, pn::MulAdd(dy, dy, hn::Mul(dz, dz)));
      N w = Fixed<kGradient>(0);
      if (!Weight::Evaluate(c, d2, dx, dy, dz, w)) continue;
      V same = one;
      if (kernel.sheets) {
        same = SameSheet(c, near);
        const V rest = pn::NegMulAdd(w.v, same, w.v);
        w = w * same;
        AddSample(c, rest, w.v, other);
      }
      inside = hn::Max(inside, pn::NegMulAdd(d2, Constant(c.inverse_reach), one));
      s.w = s.w + w;
      if constexpr (kFormula == ImplicitFormula::hoppe) {
        nearest.Add(c, d2, dx, dy, dz, same, w.v);
        continue;
      }
      AddMul(s.n, w, c.nx, c.ny, c.nz);
      s.plane = AddMul(s.plane, w, Constant(c.plane));
      s.inverse_height = AddMul(s.inverse_height, w, Constant(c.inverse_height));
      if constexpr (kPositions) AddMul(s.x, w, c.x, c.y, c.z);
      if constexpr (kCovariance) AddCovariance(c, w, point, s);
      if constexpr (kFormula == ImplicitFormula::apss) s.square = AddMul(s.square, w, Constant(c.square));
      if constexpr (kFormula == ImplicitFormula::amls) {
        V laguerre, slope;
        const V a = Constant(c.inverse_support);
        Laguerre<kOrder>(hn::Mul(d2, a), laguerre, slope);
        const N phi = w * Radial(laguerre, hn::Mul(slope, a), dx, dy, dz, kTag);
        AddMul(s.m, phi, c.mx, c.my, c.mz);
        s.plane_m = AddMul(s.plane_m, phi, Constant(c.plane_m));
      }
    }
    const auto reached = hn::Gt(s.w.v, zero);
    hn::Store(s.w.v, tag, out.weight + at);
    hn::Store(inside, tag, out.inside + at);
    s.w = Select(reached, s.w, Fixed<kGradient>(1));
    if constexpr (kNormals) {
      hn::Store(s.m.x.v, tag, out.x + at);
      hn::Store(s.m.y.v, tag, out.y + at);
      hn::Store(s.m.z.v, tag, out.z + at);
      continue;
    }
    if constexpr (kFormula == ImplicitFormula::hoppe) {
      StoreGradient(nearest.plane, at, out);
      continue;
    }
    const N mean = MeanPlane(s, point);
    N f = FromSums<kFormula, kOrder>(s, point, mean);
    if constexpr (kFormula == ImplicitFormula::extremal)
      f = Extremal<kGaussian>(candidates, p, point, s, kernel.sheets, near);
    if constexpr (kFormula != ImplicitFormula::kolluri) f = NearSurface(f, mean, s);
    if (kernel.sheets) f = Combine(f, point, s, other);
    StoreGradient(f, at, out);
  }
}

template <bool kNormals, bool kGradient>
void EvaluateGenerated(const ImplicitKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                       GroupValues& out) {
  using F = ImplicitFormula;
  if (kernel.order == 2) return Evaluate<F::amls, 2, true, kGradient, kNormals>(kernel, candidates, group, out);
  if (kernel.order == 4) return Evaluate<F::amls, 4, true, kGradient, kNormals>(kernel, candidates, group, out);
  return Evaluate<F::amls, 6, true, kGradient, kNormals>(kernel, candidates, group, out);
}

template <bool kGaussian, bool kGradient>
void EvaluateFormula(const ImplicitKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                     GroupValues& out) {
  using F = ImplicitFormula;
  switch (kernel.formula) {
    case F::hoppe:
      return Evaluate<F::hoppe, 2, false, kGradient>(kernel, candidates, group, out);
    case F::adamson:
      return Evaluate<F::adamson, 2, kGaussian, kGradient>(kernel, candidates, group, out);
    case F::adamson_covariance:
      return Evaluate<F::adamson_covariance, 2, kGaussian, kGradient>(kernel, candidates, group, out);
    case F::kolluri:
      return Evaluate<F::kolluri, 2, kGaussian, kGradient>(kernel, candidates, group, out);
    case F::extremal:
      return Evaluate<F::extremal, 2, kGaussian, kGradient>(kernel, candidates, group, out);
    case F::apss:
      return Evaluate<F::apss, 2, kGaussian, kGradient>(kernel, candidates, group, out);
    case F::amls:
      return EvaluateGenerated<false, kGradient>(kernel, candidates, group, out);
  }
}

template <bool kGradient>
void EvaluateWeights(const ImplicitKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                     GroupValues& out) {
  if (kernel.gaussian) return EvaluateFormula<true, kGradient>(kernel, candidates, group, out);
  EvaluateFormula<false, kGradient>(kernel, candidates, group, out);
}

void ImplicitValues(const ImplicitKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                    bool gradients, GroupValues& out) {
  if (gradients) return EvaluateWeights<true>(kernel, candidates, group, out);
  EvaluateWeights<false>(kernel, candidates, group, out);
}

void ImplicitNormals(const ImplicitKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                     GroupValues& out) {
  EvaluateGenerated<true, false>(kernel, candidates, group, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(ImplicitValues);
HWY_EXPORT(ImplicitNormals);

void implicit_values(const ImplicitKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                     bool gradients, GroupValues& out) {
  HWY_DYNAMIC_DISPATCH(ImplicitValues)(kernel, candidates, group, gradients, out);
}

void implicit_normals(const ImplicitKernel& kernel, std::span<const Candidate> candidates, const PointGroup& group,
                      GroupValues& out) {
  HWY_DYNAMIC_DISPATCH(ImplicitNormals)(kernel, candidates, group, out);
}

}  // namespace sansmesh::inline v1::detail
#endif
