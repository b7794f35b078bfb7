// Optimal rotation, one problem per lane (tejada2008, 6.4; horn1987). Included once per instruction set.
#if defined(SANSMESH_DEFORM_ROTATION_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SANSMESH_DEFORM_ROTATION_LANES_INL_H_
#undef SANSMESH_DEFORM_ROTATION_LANES_INL_H_
#else
#define SANSMESH_DEFORM_ROTATION_LANES_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// All products are rounded separately: fused operations would make results depend on the instruction set.
template <class V>
HWY_INLINE void QuaternionMatrix(const V (&q)[4], V (&r)[3][3]) {
  const hn::DFromV<V> d;
  const V one = hn::Set(d, 1.0), two = hn::Set(d, 2.0);
  const V xx = hn::Mul(q[1], q[1]), yy = hn::Mul(q[2], q[2]), zz = hn::Mul(q[3], q[3]);
  const V xy = hn::Mul(q[1], q[2]), yz = hn::Mul(q[2], q[3]), zx = hn::Mul(q[3], q[1]);
  const V wx = hn::Mul(q[0], q[1]), wy = hn::Mul(q[0], q[2]), wz = hn::Mul(q[0], q[3]);
  r[0][0] = hn::Sub(one, hn::Mul(two, hn::Add(yy, zz)));
  r[1][1] = hn::Sub(one, hn::Mul(two, hn::Add(zz, xx)));
  r[2][2] = hn::Sub(one, hn::Mul(two, hn::Add(xx, yy)));
  r[0][1] = hn::Mul(two, hn::Sub(xy, wz)), r[1][0] = hn::Mul(two, hn::Add(xy, wz));
  r[1][2] = hn::Mul(two, hn::Sub(yz, wx)), r[2][1] = hn::Mul(two, hn::Add(yz, wx));
  r[2][0] = hn::Mul(two, hn::Sub(zx, wy)), r[0][2] = hn::Mul(two, hn::Add(zx, wy));
}

template <class V>
HWY_INLINE void NormalizeQuaternion(V (&q)[4]) {
  const hn::DFromV<V> d;
  const V n2 =
      hn::Add(hn::Add(hn::Mul(q[0], q[0]), hn::Mul(q[1], q[1])), hn::Add(hn::Mul(q[2], q[2]), hn::Mul(q[3], q[3])));
  const auto some = hn::Gt(n2, hn::Set(d, 1e-290));
  const V one = hn::Set(d, 1.0);
  const V inverse = hn::Div(one, hn::Sqrt(hn::IfThenElse(some, n2, one)));
  q[0] = hn::IfThenElse(some, hn::Mul(q[0], inverse), one);
  for (int k = 1; k < 4; ++k) q[k] = hn::IfThenElseZero(some, hn::Mul(q[k], inverse));
}

/// Largest root of y⁴ − 2 f y² − 8 det y + c, whose roots are all real, with f about 1. Laguerre's method descends from
/// above without passing the root; it converges cubically to a simple root, else the error falls by at least a quarter
/// per step.
template <class V>
HWY_INLINE V LargestRoot(const V& f, const V& det, const V& c) {
  const hn::DFromV<V> d;
  const V four = hn::Set(d, 4.0), zero = hn::Zero(d), one = hn::Set(d, 1.0);
  const V f2 = hn::Add(f, f), det8 = hn::Mul(hn::Set(d, 8.0), det);
  V y = hn::Sqrt(hn::Mul(hn::Set(d, 3.0), f));  // bound: no sum of three singular values is larger
  auto going = hn::Eq(y, y);
  for (int step = 0; step < 24; ++step) {
    const V y2 = hn::Mul(y, y);
    const V p = hn::Add(hn::Mul(hn::Sub(hn::Mul(hn::Sub(y2, f2), y), det8), y), c);
    const V p1 = hn::Sub(hn::Mul(four, hn::Mul(y, hn::Sub(y2, f))), det8);
    const V p2 = hn::Mul(four, hn::Sub(hn::Mul(hn::Set(d, 3.0), y2), f));
    const V under = hn::Sub(hn::Mul(hn::Set(d, 9.0), hn::Mul(p1, p1)), hn::Mul(hn::Set(d, 12.0), hn::Mul(p, p2)));
    const V below = hn::Add(p1, hn::Sqrt(hn::Max(under, zero)));
    going = hn::And(going, hn::And(hn::Gt(below, hn::Set(d, 1e-290)), hn::Gt(p, zero)));
    const V down = hn::IfThenElseZero(going, hn::Div(hn::Mul(four, p), hn::IfThenElse(going, below, one)));
    y = hn::Sub(y, down);
    going = hn::And(going, hn::Gt(down, hn::Set(d, 1e-12)));
    if (hn::AllFalse(d, going)) break;
  }
  return y;
}

/// Horn's matrix of b minus y times the identity.
template <class V>
HWY_INLINE void HornMatrix(const V (&b)[3][3], const V& y, V (&n)[4][4]) {
  n[0][0] = hn::Sub(hn::Add(hn::Add(b[0][0], b[1][1]), b[2][2]), y);
  for (int k = 0; k < 3; ++k) {
    const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    n[k + 1][k + 1] = hn::Sub(hn::Sub(hn::Sub(b[k][k], b[k1][k1]), b[k2][k2]), y);
    n[0][k + 1] = n[k + 1][0] = hn::Sub(b[k2][k1], b[k1][k2]);
    n[k1 + 1][k2 + 1] = n[k2 + 1][k1 + 1] = hn::Add(b[k1][k2], b[k2][k1]);
  }
}

/// The quaternion of the largest eigenvalue of Horn's matrix of b.
template <class V>
HWY_INLINE void HornQuaternion(const V (&b)[3][3], V (&q)[4]) {
  const hn::DFromV<V> d;
  const auto minor = [](const V& a, const V& e, const V& g, const V& h)
                         HWY_ATTR { return hn::Sub(hn::Mul(a, e), hn::Mul(g, h)); };
  V f = hn::Zero(d), cofactors = hn::Zero(d), det = hn::Zero(d);
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const V c = minor(b[i1][j1], b[i2][j2], b[i1][j2], b[i2][j1]);
      f = hn::Add(f, hn::Mul(b[i][j], b[i][j])), cofactors = hn::Add(cofactors, hn::Mul(c, c));
      if (i == 0) det = hn::Add(det, hn::Mul(b[i][j], c));
    }
  }
  // det of Horn's matrix: (σ1 + σ2 + σ3)(σ1 − σ2 − σ3)(…)(…) in the singular values.
  const V rest = hn::Sub(hn::Mul(f, f), hn::Mul(hn::Set(d, 4.0), cofactors));
  const V y = LargestRoot(f, det, rest);

  V n[4][4];
  HornMatrix(b, y, n);
  // The adjugate is a multiple of q qᵀ; take its longest column.
  V s[6], c[6];
  constexpr int kPairs[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  for (int k = 0; k < 6; ++k) {
    const int i = kPairs[k][0], j = kPairs[k][1];
    s[k] = minor(n[0][i], n[1][j], n[1][i], n[0][j]), c[k] = minor(n[2][i], n[3][j], n[3][i], n[2][j]);
  }
  const auto sum = [](const V& a, const V& x, const V& e, const V& z, const V& g, const V& w)
                       HWY_ATTR { return hn::Add(hn::Sub(hn::Mul(a, x), hn::Mul(e, z)), hn::Mul(g, w)); };
  V a[4][4];
  a[0][0] = sum(n[1][1], c[5], n[1][2], c[4], n[1][3], c[3]);
  a[0][1] = hn::Neg(sum(n[0][1], c[5], n[0][2], c[4], n[0][3], c[3]));
  a[0][2] = sum(n[3][1], s[5], n[3][2], s[4], n[3][3], s[3]);
  a[0][3] = hn::Neg(sum(n[2][1], s[5], n[2][2], s[4], n[2][3], s[3]));
  a[1][1] = sum(n[0][0], c[5], n[0][2], c[2], n[0][3], c[1]);
  a[1][2] = hn::Neg(sum(n[3][0], s[5], n[3][2], s[2], n[3][3], s[1]));
  a[1][3] = sum(n[2][0], s[5], n[2][2], s[2], n[2][3], s[1]);
  a[2][2] = sum(n[3][0], s[4], n[3][1], s[2], n[3][3], s[0]);
  a[2][3] = hn::Neg(sum(n[2][0], s[4], n[2][1], s[2], n[2][3], s[0]));
  a[3][3] = sum(n[2][0], s[3], n[2][1], s[1], n[2][2], s[0]);
  for (int i = 1; i < 4; ++i)
    for (int j = 0; j < i; ++j) a[i][j] = a[j][i];
  V longest = hn::Abs(a[0][0]);
  for (int k = 0; k < 4; ++k) q[k] = a[0][k];
  for (int i = 1; i < 4; ++i) {
    const V size = hn::Abs(a[i][i]);
    const auto better = hn::Gt(size, longest);
    longest = hn::Max(size, longest);
    for (int k = 0; k < 4; ++k) q[k] = hn::IfThenElse(better, a[i][k], q[k]);
  }
  // Rescale, because entries are products of three possibly small numbers.
  V most = hn::Abs(q[0]);
  for (int k = 1; k < 4; ++k) most = hn::Max(most, hn::Abs(q[k]));
  const auto some = hn::Gt(most, hn::Set(d, 1e-290));
  const V scale = hn::Div(hn::Set(d, 1.0), hn::IfThenElse(some, most, hn::Set(d, 1.0)));
  for (int k = 0; k < 4; ++k) q[k] = hn::IfThenElseZero(some, hn::Mul(q[k], scale));
  NormalizeQuaternion(q);
}

template <class V>
HWY_INLINE V Sum3(const V& a, const V& b, const V& c) {
  return hn::Add(hn::Add(a, b), c);
}

/// q times (w, v), a quaternion, in lanes of the mask. Other lanes keep every bit: a lane's result must not depend on
/// its neighbours.
template <class V, class Mask>
HWY_INLINE void TurnQuaternion(const Mask& turns, const V& w, const V (&v)[3], V (&q)[4]) {
  const V p[4] = {q[0], q[1], q[2], q[3]};
  q[0] = hn::Sub(hn::Mul(p[0], w), Sum3(hn::Mul(p[1], v[0]), hn::Mul(p[2], v[1]), hn::Mul(p[3], v[2])));
  for (int k = 0; k < 3; ++k) {
    const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    q[k + 1] = hn::Add(hn::Add(hn::Mul(p[k + 1], w), hn::Mul(p[0], v[k])),
                       hn::Sub(hn::Mul(p[k1 + 1], v[k2]), hn::Mul(p[k2 + 1], v[k1])));
  }
  NormalizeQuaternion(q);
  for (int k = 0; k < 4; ++k) q[k] = hn::IfThenElse(turns, q[k], p[k]);
}

/// Residual of a rotation r: S = rᵀ b deviates from symmetry by `skew`; the stiffness against rotation is H = (tr S) 1
/// − S.
template <class V>
struct TurnLeft {
  // Not implicit: an implicit constructor is compiled for no particular instruction set, which ARM rejects.
  HWY_ATTR TurnLeft() {}
  V s[3][3], skew[3], stiffness[3][3], adjugate[3][3], det;  ///< the last two of H
  HWY_ATTR V trace() const { return hn::Add(hn::Add(s[0][0], s[1][1]), s[2][2]); }
};

template <class V>
HWY_INLINE void InvertStiffness(TurnLeft<V>& t) {
  const auto& h = t.stiffness;
  auto& c = t.adjugate;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = i; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c[i][j] = c[j][i] = hn::Sub(hn::Mul(h[i1][j1], h[i2][j2]), hn::Mul(h[i1][j2], h[i2][j1]));
    }
  }
  t.det = Sum3(hn::Mul(h[0][0], c[0][0]), hn::Mul(h[0][1], c[0][1]), hn::Mul(h[0][2], c[0][2]));
}

template <class V>
HWY_INLINE TurnLeft<V> WhatIsLeft(const V (&b)[3][3], const V (&r)[3][3]) {
  const hn::DFromV<V> d;
  TurnLeft<V> t;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      t.s[i][j] = Sum3(hn::Mul(r[0][i], b[0][j]), hn::Mul(r[1][i], b[1][j]), hn::Mul(r[2][i], b[2][j]));
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    t.skew[i] = hn::Sub(t.s[k][j], t.s[j][k]);
    t.stiffness[i][i] = hn::Add(t.s[j][j], t.s[k][k]);
    t.stiffness[j][k] = t.stiffness[k][j] = hn::Mul(hn::Set(d, -0.5), hn::Add(t.s[j][k], t.s[k][j]));
  }
  InvertStiffness(t);
  return t;
}

/// Half of the Newton rotation, and its squared length.
template <class V>
HWY_INLINE V HalfTurn(const TurnLeft<V>& t, const V& half_over_det, V (&w)[3]) {
  for (int k = 0; k < 3; ++k)
    w[k] = hn::Mul(half_over_det, Sum3(hn::Mul(t.adjugate[k][0], t.skew[0]), hn::Mul(t.adjugate[k][1], t.skew[1]),
                                       hn::Mul(t.adjugate[k][2], t.skew[2])));
  return Sum3(hn::Mul(w[0], w[0]), hn::Mul(w[1], w[1]), hn::Mul(w[2], w[2]));
}

/// Unit axis of least stiffness; zero if there is none.
template <class V>
HWY_INLINE void WeakAxis(const TurnLeft<V>& t, V (&e)[3]) {
  const hn::DFromV<V> d;
  V longest = hn::Abs(t.adjugate[0][0]);
  for (int k = 0; k < 3; ++k) e[k] = t.adjugate[0][k];
  for (int i = 1; i < 3; ++i) {
    const V size = hn::Abs(t.adjugate[i][i]);
    const auto better = hn::Gt(size, longest);
    longest = hn::Max(longest, size);
    for (int k = 0; k < 3; ++k) e[k] = hn::IfThenElse(better, t.adjugate[i][k], e[k]);
  }
  const V square = Sum3(hn::Mul(e[0], e[0]), hn::Mul(e[1], e[1]), hn::Mul(e[2], e[2]));
  const auto some = hn::Gt(square, hn::Set(d, 1e-290));
  const V scale = hn::Div(hn::Set(d, 1.0), hn::Sqrt(hn::IfThenElse(some, square, hn::Set(d, 1.0))));
  for (V& v : e) v = hn::IfThenElseZero(some, hn::Mul(v, scale));
}

/// Where rotations about one axis have almost no stiffness, the quartic determines them only to the square root of the
/// rounding error. Computes the exact optimum about that axis, after correcting all others.
template <class V>
HWY_INLINE void TurnAboutWeakAxis(const V (&b)[3][3], V (&q)[4], V (&r)[3][3]) {
  const hn::DFromV<V> d;
  const V one = hn::Set(d, 1.0), zero = hn::Zero(d), half = hn::Set(d, 0.5);
  TurnLeft<V> t = WhatIsLeft(b, r);
  const auto weak = hn::Lt(hn::Abs(t.det), hn::Set(d, 0.05));
  if (hn::AllFalse(d, weak)) return;
  V e[3], w[3];
  for (int step = 0; step < 2; ++step) {
    WeakAxis(t, e);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) t.stiffness[i][j] = hn::Add(t.stiffness[i][j], hn::Mul(e[i], e[j]));
    InvertStiffness(t);
    const auto solvable = hn::And(weak, hn::Gt(t.det, hn::Set(d, 1e-3)));
    const V size = HalfTurn(t, hn::Div(half, hn::IfThenElse(solvable, t.det, one)), w);
    const auto turns = hn::And(solvable, hn::Lt(size, hn::Set(d, 0.05)));
    TurnQuaternion(turns, one, w, q);
    QuaternionMatrix(q, r);
    t = WhatIsLeft(b, r);
  }
  WeakAxis(t, e);
  V along = zero;  // eᵀ S e
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) along = hn::Add(along, hn::Mul(hn::Mul(e[i], e[j]), t.s[i][j]));
  const V x = hn::Sub(t.trace(), along);
  const V y = Sum3(hn::Mul(e[0], t.skew[0]), hn::Mul(e[1], t.skew[1]), hn::Mul(e[2], t.skew[2]));
  const V radius = hn::Sqrt(hn::Add(hn::Mul(x, x), hn::Mul(y, y)));
  const auto turns = hn::And(weak, hn::Gt(radius, hn::Set(d, 1e-290)));
  const V inverse = hn::Div(one, hn::IfThenElse(turns, radius, one));
  const V cosine = hn::IfThenElse(turns, hn::Mul(x, inverse), one);
  const V sine = hn::IfThenElseZero(turns, hn::Mul(y, inverse));
  // Half of the angle, from the larger of its sine and cosine.
  const V larger = hn::Sqrt(hn::Mul(half, hn::Add(one, hn::Abs(cosine))));
  const V smaller = hn::Div(hn::Mul(half, sine), larger);
  const auto acute = hn::Ge(cosine, zero);
  const V across = hn::IfThenElse(acute, smaller, larger);
  for (int k = 0; k < 3; ++k) w[k] = hn::Mul(across, e[k]);
  TurnQuaternion(turns, hn::IfThenElse(acute, larger, smaller), w, q);
  QuaternionMatrix(q, r);
}

/// Newton's method on the rotations corrects the rounding errors of the quartic's coefficients. Returns the lanes that
/// converged to a certain optimum: stiff against all rotations beyond rounding.
template <class V>
HWY_INLINE auto PolishRotation(const V (&b)[3][3], V (&q)[4], V (&r)[3][3]) {
  const hn::DFromV<V> d;
  const V zero = hn::Zero(d);
  auto going = hn::Eq(q[0], q[0]), best = hn::Ne(q[0], q[0]);
  for (int step = 0; step < 5; ++step) {
    const TurnLeft<V> t = WhatIsLeft(b, r);
    going = hn::And(going, hn::Gt(t.det, hn::Set(d, 1e-16)));
    V w[3];
    const V size = HalfTurn(t, hn::Div(hn::Set(d, 0.5), hn::IfThenElse(going, t.det, hn::Set(d, 1.0))), w);
    going = hn::And(going, hn::Lt(size, hn::Set(d, 0.01)));
    TurnQuaternion(going, hn::Set(d, 1.0), w, q);
    QuaternionMatrix(q, r);
    const V pairs = Sum3(t.adjugate[0][0], t.adjugate[1][1], t.adjugate[2][2]);
    const auto holds = hn::And(hn::Gt(t.det, hn::Set(d, 1e-12)), hn::And(hn::Gt(pairs, zero), hn::Gt(t.trace(), zero)));
    const auto rests = hn::Le(size, hn::Set(d, 1e-20));  // the next would be its square
    best = hn::Or(best, hn::And(going, hn::And(rests, holds)));
    going = hn::AndNot(rests, going);
    if (hn::AllFalse(d, going)) break;
  }
  return best;
}

/// True where the residual is at rounding level and at most one rotation has little stiffness: the optimum.
template <class V>
HWY_INLINE auto IsBest(const V (&b)[3][3], const V (&r)[3][3]) {
  const hn::DFromV<V> d;
  const TurnLeft<V> t = WhatIsLeft(b, r);
  const V skew = Sum3(hn::Mul(t.skew[0], t.skew[0]), hn::Mul(t.skew[1], t.skew[1]), hn::Mul(t.skew[2], t.skew[2]));
  const V pairs = Sum3(t.adjugate[0][0], t.adjugate[1][1], t.adjugate[2][2]);
  return hn::And(hn::And(hn::Lt(skew, hn::Set(d, 1e-26)), hn::Gt(t.trace(), hn::Zero(d))),
                 hn::And(hn::Gt(pairs, hn::Set(d, 1e-2)), hn::Gt(t.det, hn::Set(d, -1e-15))));
}

template <class V>
HWY_INLINE V Alignment(const V (&b)[3][3], const V (&r)[3][3]) {
  V sum = hn::Zero(hn::DFromV<V>());
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum = hn::Add(sum, hn::Mul(b[i][j], r[i][j]));
  return sum;
}

/// The optimum by Jacobi's method on Horn's matrix, in lanes of the mask, for reflected sets that are (nearly)
/// symmetric about an axis or a point, where several roots of the quartic coincide. The number of sweeps is the same
/// for all lanes.
template <class V, class Mask>
HWY_NOINLINE void RepairRotation(const V (&b)[3][3], const Mask& wanted, V (&r)[3][3]) {
  const hn::DFromV<V> d;
  constexpr int kSweeps = 7;
  const V one = hn::Set(d, 1.0), zero = hn::Zero(d), half = hn::Set(d, 0.5);
  V a[4][4], v[4][4];
  HornMatrix(b, zero, a);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) v[i][j] = i == j ? one : zero;
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int i = 0; i < 3; ++i)
      for (int j = i + 1; j < 4; ++j) {
        // Tangent of the smaller angle that makes a[i][j] zero.
        const V off = a[i][j], difference = hn::Mul(half, hn::Sub(a[j][j], a[i][i]));
        const V root = hn::Sqrt(hn::Add(hn::Mul(difference, difference), hn::Mul(off, off)));
        const V under = hn::Add(hn::Abs(difference), root);
        const auto some = hn::Gt(under, hn::Set(d, 1e-290));
        const V size = hn::IfThenElseZero(some, hn::Div(off, hn::IfThenElse(some, under, one)));
        const V tangent = hn::IfThenElse(hn::Lt(difference, zero), hn::Neg(size), size);
        const V c = hn::Div(one, hn::Sqrt(hn::Add(one, hn::Mul(tangent, tangent)))), s = hn::Mul(tangent, c);
        a[i][i] = hn::Sub(a[i][i], hn::Mul(tangent, off)), a[j][j] = hn::Add(a[j][j], hn::Mul(tangent, off));
        a[i][j] = a[j][i] = zero;
        for (int k = 0; k < 4; ++k) {
          const V x = v[k][i], y = v[k][j];
          v[k][i] = hn::Sub(hn::Mul(c, x), hn::Mul(s, y)), v[k][j] = hn::Add(hn::Mul(s, x), hn::Mul(c, y));
          if (k == i || k == j) continue;
          const V e = a[k][i], f = a[k][j];
          a[k][i] = a[i][k] = hn::Sub(hn::Mul(c, e), hn::Mul(s, f));
          a[k][j] = a[j][k] = hn::Add(hn::Mul(s, e), hn::Mul(c, f));
        }
      }
  V most = a[0][0], q[4] = {v[0][0], v[1][0], v[2][0], v[3][0]};
  for (int i = 1; i < 4; ++i) {
    const auto more = hn::Gt(a[i][i], most);
    most = hn::Max(most, a[i][i]);
    for (int k = 0; k < 4; ++k) q[k] = hn::IfThenElse(more, v[k][i], q[k]);
  }
  NormalizeQuaternion(q);
  V found[3][3];
  QuaternionMatrix(q, found);
  const auto good = hn::Gt(hn::Add(Alignment(b, found), hn::Set(d, 1e-15)), Alignment(b, r));
  const auto taken = hn::And(wanted, good);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r[i][j] = hn::IfThenElse(taken, found[i][j], r[i][j]);
}

/// The rotation r that maximises Σ r_ij b_ij. Of several optima (rank of b at most 1) the smallest rotation, by adding
/// 10⁻¹⁴ of b's norm times the identity. b may have any scale; its squared entries need not be representable.
template <class V>
HWY_INLINE void BestRotation(const V (&b)[3][3], V (&r)[3][3]) {
  const hn::DFromV<V> d;
  const V one = hn::Set(d, 1.0), tiny = hn::Set(d, 1e-290);
  V most = hn::Zero(d);
  for (const auto& row : b)
    for (const V& e : row) most = hn::Max(most, hn::Abs(e));
  const auto some = hn::Gt(most, tiny);
  const V scale = hn::Div(one, hn::IfThenElse(some, most, one));
  V c[3][3], norm = hn::Zero(d);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      c[i][j] = hn::IfThenElseZero(some, hn::Mul(b[i][j], scale));
      norm = hn::Add(norm, hn::Mul(c[i][j], c[i][j]));
    }
  const V unit = hn::Div(one, hn::Sqrt(hn::IfThenElse(some, norm, one)));
  for (auto& row : c)
    for (V& e : row) e = hn::Mul(e, unit);
  for (int k = 0; k < 3; ++k) c[k][k] = hn::Add(c[k][k], hn::Set(d, 1e-14));
  V q[4];
  HornQuaternion(c, q);
  QuaternionMatrix(q, r);
  TurnAboutWeakAxis(c, q, r);
  auto best = PolishRotation(c, q, r);
  if (hn::AllTrue(d, best)) return;
  best = hn::Or(best, IsBest(c, r));
  if (!hn::AllTrue(d, best)) RepairRotation(c, hn::Not(best), r);
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#endif
