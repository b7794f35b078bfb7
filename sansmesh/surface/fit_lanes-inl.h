// Planes and polynomials fitted to samples, one point per lane: shared by the kernels of projections. Included once for
// each instruction set.
#if defined(SANSMESH_SURFACE_FIT_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SANSMESH_SURFACE_FIT_LANES_INL_H_
#undef SANSMESH_SURFACE_FIT_LANES_INL_H_
#else
#define SANSMESH_SURFACE_FIT_LANES_INL_H_
#endif

#include <cstddef>
#include <span>

#include "sansmesh/surface/near_normals-inl.h"
#include "sansmesh/surface/sample_group.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {

constexpr float kLeast = 1e-30f;  // smallest divisor of squares
constexpr int kInverseSteps = 4;  // steps of the inverse iteration; the smallest eigenvalue is far below the others
/// Ridge of the normal equations, relative to the diagonal: too few samples give the flattest surface.
constexpr float kRidge = 1e-5f;

HWY_INLINE V Times(const V& a, const V& b) { return hn::Mul(a, b); }
HWY_INLINE V Dot3(const Lanes& a, const Lanes& b) {
  return pn::MulAdd(a.x, b.x, pn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE Lanes Along(const Lanes& p, const Lanes& n, const V& t) {
  return {pn::MulAdd(n.x, t, p.x), pn::MulAdd(n.y, t, p.y), pn::MulAdd(n.z, t, p.z)};
}
HWY_INLINE Lanes Unit(const Lanes& a, const Lanes& otherwise) {
  const V n2 = Dot3(a, a);
  const auto good = hn::Gt(n2, Constant(kLeast));
  const V inverse = hn::Div(Constant(1), hn::Sqrt(hn::IfThenElse(good, n2, Constant(1))));
  return {hn::IfThenElse(good, Times(a.x, inverse), otherwise.x),
          hn::IfThenElse(good, Times(a.y, inverse), otherwise.y),
          hn::IfThenElse(good, Times(a.z, inverse), otherwise.z)};
}

/// The frame of tangent_frame() in sansmesh/vec.h.
HWY_INLINE void TangentFrame(const Lanes& n, Lanes& t, Lanes& b) {
  const V one = Constant(1);
  const V sign = hn::CopySign(one, n.z);
  const V a = hn::Div(Constant(-1), hn::Add(sign, n.z));
  const V c = Times(Times(n.x, n.y), a);
  t = {pn::MulAdd(Times(Times(sign, n.x), n.x), a, one), Times(sign, c), hn::Neg(Times(sign, n.x))};
  b = {c, pn::MulAdd(Times(n.y, n.y), a, sign), hn::Neg(n.y)};
}

/// A frame whose coordinates are lengths over h.
struct ScaledFrame {
  Lanes t, b, n;
};
HWY_INLINE ScaledFrame Scaled(const Lanes& t, const Lanes& b, const Lanes& n, const V& unit) {
  const auto by = [&](const Lanes& a) { return Lanes{Times(a.x, unit), Times(a.y, unit), Times(a.z, unit)}; };
  return {by(t), by(b), by(n)};
}

/// Unit vector of least variance of a covariance matrix, by inverse iteration with its adjugate from `start`.
HWY_INLINE Lanes LeastAxis(V xx, V xy, V xz, V yy, V yz, V zz, const Lanes& start) {
  const V trace = hn::Max(hn::Add(xx, hn::Add(yy, zz)), Constant(kLeast));
  const V scale = hn::Div(Constant(1), trace);
  const V ridge = Constant(1e-5f);
  xx = pn::MulAdd(xx, scale, ridge), yy = pn::MulAdd(yy, scale, ridge), zz = pn::MulAdd(zz, scale, ridge);
  xy = Times(xy, scale), xz = Times(xz, scale), yz = Times(yz, scale);
  const auto cofactor = [](const V& a, const V& b, const V& c, const V& d) { return pn::NegMulAdd(b, c, Times(a, d)); };
  const V axx = cofactor(yy, yz, yz, zz), axy = cofactor(xz, xy, zz, yz), axz = cofactor(xy, xz, yy, yz);
  const V ayy = cofactor(xx, xz, xz, zz), ayz = cofactor(xy, xx, yz, xz), azz = cofactor(xx, xy, xy, yy);
  Lanes n = start;
  for (int k = 0; k < kInverseSteps; ++k) {
    const Lanes next{pn::MulAdd(axx, n.x, pn::MulAdd(axy, n.y, Times(axz, n.z))),
                     pn::MulAdd(axy, n.x, pn::MulAdd(ayy, n.y, Times(ayz, n.z))),
                     pn::MulAdd(axz, n.x, pn::MulAdd(ayz, n.y, Times(azz, n.z)))};
    n = Unit(next, n);
  }
  const V side = hn::CopySign(Constant(1), Dot3(n, start));
  return {Times(n.x, side), Times(n.y, side), Times(n.z, side)};
}

/// The same with the precision of floats for any ratio of the eigenvalues: steps shifted by Rayleigh's quotient follow,
/// whose adjugate tends to the projection on the eigenvector. The trace should be about 1.
HWY_INLINE Lanes LeastEigenvector(const V& xx, const V& xy, const V& xz, const V& yy, const V& yz, const V& zz,
                                  const Lanes& start) {
  Lanes n = LeastAxis(xx, xy, xz, yy, yz, zz, start);
  const auto cofactor = [](const V& a, const V& b, const V& c, const V& d) { return pn::NegMulAdd(b, c, Times(a, d)); };
  for (int k = 0; k < 2; ++k) {
    const Lanes cn{pn::MulAdd(xx, n.x, pn::MulAdd(xy, n.y, Times(xz, n.z))),
                   pn::MulAdd(xy, n.x, pn::MulAdd(yy, n.y, Times(yz, n.z))),
                   pn::MulAdd(xz, n.x, pn::MulAdd(yz, n.y, Times(zz, n.z)))};
    const V shift = Dot3(n, cn);
    const V sx = hn::Sub(xx, shift), sy = hn::Sub(yy, shift), sz = hn::Sub(zz, shift);
    const V axx = cofactor(sy, yz, yz, sz), axy = cofactor(xz, xy, sz, yz), axz = cofactor(xy, xz, sy, yz);
    const V ayy = cofactor(sx, xz, xz, sz), ayz = cofactor(xy, sx, yz, xz), azz = cofactor(sx, xy, xy, sy);
    n = Unit({pn::MulAdd(axx, n.x, pn::MulAdd(axy, n.y, Times(axz, n.z))),
              pn::MulAdd(axy, n.x, pn::MulAdd(ayy, n.y, Times(ayz, n.z))),
              pn::MulAdd(axz, n.x, pn::MulAdd(ayz, n.y, Times(azz, n.z)))},
             n);
  }
  const V side = hn::CopySign(Constant(1), Dot3(n, start));
  return {Times(n.x, side), Times(n.y, side), Times(n.z, side)};
}

/// Solves the symmetric positive definite systems of kSize unknowns in place: the lower triangle of `a` (row by row)
/// becomes its Cholesky factor, `b` the solution.
template <int kSize>
HWY_INLINE void SolveLanes(V* a, V* b) {
  const auto at = [](int i, int j) { return i * (i + 1) / 2 + j; };
  for (int j = 0; j < kSize; ++j) {
    V pivot = a[at(j, j)];
    const V least = hn::Max(Times(pivot, Constant(kRidge)), Constant(kLeast));
    pivot = pn::MulAdd(pivot, Constant(kRidge), pivot);
    for (int k = 0; k < j; ++k) pivot = pn::NegMulAdd(a[at(j, k)], a[at(j, k)], pivot);
    const V root = hn::Sqrt(hn::Max(pivot, least));
    const V inverse = hn::Div(Constant(1), root);
    a[at(j, j)] = inverse;
    for (int i = j + 1; i < kSize; ++i) {
      V sum = a[at(i, j)];
      for (int k = 0; k < j; ++k) sum = pn::NegMulAdd(a[at(i, k)], a[at(j, k)], sum);
      a[at(i, j)] = Times(sum, inverse);
    }
  }
  for (int i = 0; i < kSize; ++i) {
    for (int k = 0; k < i; ++k) b[i] = pn::NegMulAdd(a[at(i, k)], b[k], b[i]);
    b[i] = Times(b[i], a[at(i, i)]);
  }
  for (int i = kSize - 1; i >= 0; --i) {
    for (int k = i + 1; k < kSize; ++k) b[i] = pn::NegMulAdd(a[at(k, i)], b[k], b[i]);
    b[i] = Times(b[i], a[at(i, i)]);
  }
}

struct Offset {
  V x, y, z, square;
};
HWY_INLINE Offset From(const Lanes& p, const Candidate& c) {
  const V x = hn::Sub(Constant(c.x), p.x), y = hn::Sub(Constant(c.y), p.y), z = hn::Sub(Constant(c.z), p.z);
  return {x, y, z, pn::MulAdd(x, x, pn::MulAdd(y, y, Times(z, z)))};
}

/// Weight of a candidate at the offset; false if it reaches no lane.
template <bool kGaussian = false>
HWY_INLINE bool WeightAt(const Candidate& c, const Offset& o, bool sheets, const Lanes& near, V& w) {
  if constexpr (kGaussian) {
    Value weight{hn::Zero(Tag())};
    if (!GaussianWeight<false>::Evaluate(c, o.square, o.x, o.y, o.z, weight)) return false;
    w = weight.v;
  } else {
    const V t = hn::Max(pn::NegMulAdd(o.square, Constant(c.inverse_support), Constant(1)), hn::Zero(Tag()));
    if (hn::AllFalse(Tag(), hn::Gt(t, hn::Zero(Tag())))) return false;
    const V t2 = Times(t, t);
    w = Times(Times(t2, t2), Constant(c.weight));
  }
  if (sheets) w = Times(w, SameSheet(c, near));
  return true;
}

struct Plane {
  Lanes normal;
  V distance;  // distance of the point from the plane, along the normal: the plane passes through p + distance · normal
  V width2;    // weighted mean of h²
};

/// Plane through the weighted mean of the samples, with their mean normal or that of least squares.
template <bool kLeastSquares, bool kGaussian = false>
HWY_INLINE Plane FitPlane(std::span<const Candidate> candidates, const Lanes& p, bool sheets, const Lanes& near,
                          V* inside) {
  const V zero = hn::Zero(Tag());
  V w0 = zero, wx = zero, wy = zero, wz = zero, nx = zero, ny = zero, nz = zero;
  V xx = zero, xy = zero, xz = zero, yy = zero, yz = zero, zz = zero, h2 = zero, reach = Constant(-1);
  for (const Candidate& c : candidates) {
    const Offset o = From(p, c);
    V w;
    if (!WeightAt<kGaussian>(c, o, sheets, near, w)) continue;
    reach = hn::Max(reach, pn::NegMulAdd(o.square, Constant(c.inverse_reach), Constant(1)));
    const V ax = Times(w, o.x), ay = Times(w, o.y), az = Times(w, o.z);
    w0 = hn::Add(w0, w), wx = hn::Add(wx, ax), wy = hn::Add(wy, ay), wz = hn::Add(wz, az);
    nx = pn::MulAdd(w, Constant(c.nx), nx), ny = pn::MulAdd(w, Constant(c.ny), ny),
    nz = pn::MulAdd(w, Constant(c.nz), nz);
    h2 = pn::MulAdd(w, Constant((kGaussian ? 1.0f : 0.25f) / c.inverse_support), h2);
    if constexpr (kLeastSquares) {
      xx = pn::MulAdd(ax, o.x, xx), xy = pn::MulAdd(ax, o.y, xy), xz = pn::MulAdd(ax, o.z, xz);
      yy = pn::MulAdd(ay, o.y, yy), yz = pn::MulAdd(ay, o.z, yz), zz = pn::MulAdd(az, o.z, zz);
    }
  }
  if (inside) *inside = hn::IfThenElse(hn::Gt(w0, zero), reach, Constant(-1));
  const V inverse = hn::Div(Constant(1), hn::Max(w0, Constant(kLeast)));
  const Lanes mean{Times(wx, inverse), Times(wy, inverse), Times(wz, inverse)};
  Lanes n = Unit({nx, ny, nz}, {zero, zero, Constant(1)});
  if constexpr (kLeastSquares)
    n = LeastAxis(pn::NegMulAdd(wx, mean.x, xx), pn::NegMulAdd(wx, mean.y, xy), pn::NegMulAdd(wx, mean.z, xz),
                  pn::NegMulAdd(wy, mean.y, yy), pn::NegMulAdd(wy, mean.z, yz), pn::NegMulAdd(wz, mean.z, zz), n);
  return {n, Dot3(n, mean), Times(h2, inverse)};
}

/// Points of a group from index `at` on.
HWY_INLINE Lanes PointsAt(const PointGroup& group, std::size_t at) {
  const Tag d;
  return {hn::Load(d, group.x + at), hn::Load(d, group.y + at), hn::Load(d, group.z + at)};
}

/// A step to Levin's plane: the least-squares plane with weights about q, its distance measured from x.
template <bool kGaussian = false>
HWY_INLINE Plane PlaneBelow(std::span<const Candidate> candidates, const Lanes& q, const Lanes& x, bool sheets,
                            const Lanes& near) {
  Plane plane = FitPlane<true, kGaussian>(candidates, q, sheets, near, nullptr);
  const Lanes from_x{hn::Sub(q.x, x.x), hn::Sub(q.y, x.y), hn::Sub(q.z, x.z)};
  plane.distance = hn::Add(Dot3(plane.normal, from_x), plane.distance);
  return plane;
}

HWY_INLINE void StoreFoot(const Lanes& p, const Lanes& n, const V& xx, const V& xy, const V& yy, const V& inside,
                          std::size_t at, GroupFeet& out) {
  const Tag d;
  hn::Store(p.x, d, out.x + at), hn::Store(p.y, d, out.y + at), hn::Store(p.z, d, out.z + at);
  hn::Store(n.x, d, out.nx + at), hn::Store(n.y, d, out.ny + at), hn::Store(n.z, d, out.nz + at);
  hn::Store(xx, d, out.xx + at), hn::Store(xy, d, out.xy + at), hn::Store(yy, d, out.yy + at);
  hn::Store(inside, d, out.inside + at);
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#endif
