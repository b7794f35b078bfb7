#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/volume/kernels/cell_blend_kernels.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include "sansmesh/core/portable-inl.h"
#include "sansmesh/volume/kernels/cell_blend_kernels.h"
#include "sansmesh/volume/kernels/local_monomials-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace pn = portable::HWY_NAMESPACE;

using BlendTag = hn::CappedTag<float, 16>;
using BlendV = hn::Vec<BlendTag>;

// A number and its gradient.
template <bool kGradient>
struct Dual {
  // Not implicit: an implicit constructor is compiled without an instruction set, which fails on ARM.
  HWY_ATTR Dual() {}
  BlendV v;
  BlendV g[kGradient ? 3 : 1];
};

template <bool kGradient>
HWY_INLINE Dual<kGradient> Plus(const Dual<kGradient>& a, const Dual<kGradient>& b) {
  Dual<kGradient> r;
  r.v = hn::Add(a.v, b.v);
  if (kGradient)
    for (int k = 0; k < 3; ++k) r.g[k] = hn::Add(a.g[k], b.g[k]);
  return r;
}
template <bool kGradient>
HWY_INLINE Dual<kGradient> Times(const Dual<kGradient>& a, const Dual<kGradient>& b) {
  Dual<kGradient> r;
  r.v = hn::Mul(a.v, b.v);
  if (kGradient)
    for (int k = 0; k < 3; ++k) r.g[k] = pn::MulAdd(a.v, b.g[k], hn::Mul(a.g[k], b.v));
  return r;
}
template <bool kGradient>
HWY_INLINE Dual<kGradient> Over(const Dual<kGradient>& a, const Dual<kGradient>& b) {
  const BlendTag d;
  Dual<kGradient> r;
  const auto inverse = hn::Div(hn::Set(d, 1.0f), hn::Max(b.v, hn::Set(d, 1e-30f)));
  r.v = hn::Mul(a.v, inverse);
  if (kGradient)
    for (int k = 0; k < 3; ++k) r.g[k] = hn::Mul(pn::NegMulAdd(r.v, b.g[k], a.g[k]), inverse);
  return r;
}
template <bool kGradient>
HWY_INLINE Dual<kGradient> OneMinus(const Dual<kGradient>& a) {
  Dual<kGradient> r;
  r.v = hn::Sub(hn::Set(BlendTag(), 1.0f), a.v);
  if (kGradient)
    for (int k = 0; k < 3; ++k) r.g[k] = hn::Neg(a.g[k]);
  return r;
}
// s(t) = t² (3 − 2t), t clamped to [0, 1].
template <bool kGradient>
HWY_INLINE Dual<kGradient> Step(const Dual<kGradient>& a) {
  const BlendTag d;
  Dual<kGradient> r;
  const auto one = hn::Set(d, 1.0f);
  const auto t = hn::Min(hn::Max(a.v, hn::Zero(d)), one);
  r.v = hn::Mul(hn::Mul(t, t), pn::NegMulAdd(hn::Set(d, 2.0f), t, hn::Set(d, 3.0f)));
  if (kGradient) {
    const auto slope = hn::Mul(hn::Set(d, 6.0f), hn::Mul(t, hn::Sub(one, t)));
    for (int k = 0; k < 3; ++k) r.g[k] = hn::Mul(slope, a.g[k]);
  }
  return r;
}

template <bool kGradient>
void BlendWeightsT(CellShape shape, std::size_t n, CellTile& tile) {
  const BlendTag d;
  using T = Dual<kGradient>;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const auto N = [&](int v) HWY_ATTR {
      T t;
      t.v = hn::Load(d, tile.weights[v] + i);
      if (kGradient)
        for (int k = 0; k < 3; ++k) t.g[k] = hn::Load(d, tile.slopes[v][k] + i);
      return t;
    };
    const auto put = [&](int v, const T& t) HWY_ATTR {
      hn::Store(t.v, d, tile.blend[v] + i);
      if (kGradient)
        for (int k = 0; k < 3; ++k) hn::Store(t.g[k], d, tile.blend_slopes[v][k] + i);
    };
    switch (shape) {
      case CellShape::hexahedron: {
        const auto axis = [&](int a, int b, int c, int e)
                              HWY_ATTR { return Step(Plus(Plus(N(a), N(b)), Plus(N(c), N(e)))); };
        const T a = axis(1, 2, 5, 6), b = axis(2, 3, 6, 7), c = axis(4, 5, 6, 7);
        const T a0 = OneMinus(a), b0 = OneMinus(b), c0 = OneMinus(c);
        const T ring[4] = {Times(a0, b0), Times(a, b0), Times(a, b), Times(a0, b)};
        for (int v = 0; v < 4; ++v) put(v, Times(ring[v], c0)), put(v + 4, Times(ring[v], c));
        break;
      }
      case CellShape::wedge: {
        T t[3];
        for (int v = 0; v < 3; ++v) t[v] = Step(Plus(N(v), N(v + 3)));
        const T sum = Plus(Plus(t[0], t[1]), t[2]);
        const T c = Step(Plus(Plus(N(3), N(4)), N(5))), c0 = OneMinus(c);
        for (int v = 0; v < 3; ++v) {
          const T share = Over(t[v], sum);
          put(v, Times(share, c0)), put(v + 3, Times(share, c));
        }
        break;
      }
      case CellShape::pyramid: {
        // g_v = s(t (1 − a)) s(t (1 − b)) / s(t) with t = 1 − N_tip and t a = N_1 + N_2: on the base, where t = 1, the
        // product of hexahedra, on the other faces s(N_v).
        const T tip = N(4), base = OneMinus(tip);
        const T ta = Plus(N(1), N(2)), tb = Plus(N(2), N(3)), ta0 = Plus(N(0), N(3)), tb0 = Plus(N(0), N(1));
        const T a = Step(ta), b = Step(tb), a0 = Step(ta0), b0 = Step(tb0), under = Step(base);
        T g[5] = {Over(Times(a0, b0), under), Over(Times(a, b0), under), Over(Times(a, b), under),
                  Over(Times(a0, b), under), Step(tip)};
        T sum = g[0];
        for (int v = 1; v < 5; ++v) sum = Plus(sum, g[v]);
        for (int v = 0; v < 5; ++v) put(v, Over(g[v], sum));
        break;
      }
      case CellShape::tetrahedron: {
        T g[4];
        for (int v = 0; v < 4; ++v) g[v] = Step(N(v));
        const T sum = Plus(Plus(g[0], g[1]), Plus(g[2], g[3]));
        for (int v = 0; v < 4; ++v) put(v, Over(g[v], sum));
        break;
      }
    }
  }
}

void BlendWeights(CellShape shape, std::size_t n, bool gradient, CellTile& tile) {
  if (gradient)
    BlendWeightsT<true>(shape, n, tile);
  else
    BlendWeightsT<false>(shape, n, tile);
}

template <bool kGradient>
void BlendCornersT(const CellCorner* corners, std::size_t count, std::size_t n, bool own, CellTile& tile) {
  const BlendTag d;
  bool linear = false;
  for (std::size_t v = 0; v < count; ++v) linear = linear || corners[v].trust < 1;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    BlendV lv = hn::Zero(d), lx = lv, ly = lv, lz = lv;
    if (linear && own) {
      lv = hn::Load(d, tile.own + i);
      if (kGradient)
        lx = hn::Load(d, tile.own_slopes[0] + i), ly = hn::Load(d, tile.own_slopes[1] + i),
        lz = hn::Load(d, tile.own_slopes[2] + i);
    } else if (linear) {
      for (std::size_t v = 0; v < count; ++v) {
        const auto f = hn::Set(d, corners[v].value);
        lv = pn::MulAdd(hn::Load(d, tile.weights[v] + i), f, lv);
        if (kGradient) {
          lx = pn::MulAdd(hn::Load(d, tile.slopes[v][0] + i), f, lx);
          ly = pn::MulAdd(hn::Load(d, tile.slopes[v][1] + i), f, ly);
          lz = pn::MulAdd(hn::Load(d, tile.slopes[v][2] + i), f, lz);
        }
      }
    }
    BlendV value = hn::Zero(d), gx = value, gy = value, gz = value;
    for (std::size_t v = 0; v < count; ++v) {
      const CellCorner& c = corners[v];
      const auto x = hn::Load(d, tile.offsets[v][0] + i), y = hn::Load(d, tile.offsets[v][1] + i),
                 z = hn::Load(d, tile.offsets[v][2] + i);
      const auto along = [&](const Vec3f& row) HWY_ATTR {
        return pn::MulAdd(x, hn::Set(d, row.x), pn::MulAdd(y, hn::Set(d, row.y), hn::Mul(z, hn::Set(d, row.z))));
      };
      BlendV p, pu = value, pv = value, pw = value;
      SumMonomials<kGradient>(d, c.degree, c.coefficients, along(c.metric.rows[0]), along(c.metric.rows[1]),
                              along(c.metric.rows[2]), p, pu, pv, pw);
      p = hn::Add(p, hn::Set(d, c.constant));
      BlendV px = p, py = p, pz = p;
      if (kGradient) {
        const auto back = [&](float a, float b, float e) HWY_ATTR {
          return pn::MulAdd(pu, hn::Set(d, a), pn::MulAdd(pv, hn::Set(d, b), hn::Mul(pw, hn::Set(d, e))));
        };
        const auto& r = c.metric.rows;
        px = back(r[0].x, r[1].x, r[2].x), py = back(r[0].y, r[1].y, r[2].y), pz = back(r[0].z, r[1].z, r[2].z);
      }
      if (c.trust < 1) {
        const auto t = hn::Set(d, c.trust), rest = hn::Set(d, 1 - c.trust);
        p = pn::MulAdd(t, p, hn::Mul(rest, lv));
        if (kGradient) {
          px = pn::MulAdd(t, px, hn::Mul(rest, lx));
          py = pn::MulAdd(t, py, hn::Mul(rest, ly));
          pz = pn::MulAdd(t, pz, hn::Mul(rest, lz));
        }
      }
      const auto s = hn::Load(d, tile.blend[v] + i);
      value = pn::MulAdd(s, p, value);
      if (kGradient) {
        gx = pn::MulAdd(s, px, pn::MulAdd(hn::Load(d, tile.blend_slopes[v][0] + i), p, gx));
        gy = pn::MulAdd(s, py, pn::MulAdd(hn::Load(d, tile.blend_slopes[v][1] + i), p, gy));
        gz = pn::MulAdd(s, pz, pn::MulAdd(hn::Load(d, tile.blend_slopes[v][2] + i), p, gz));
      }
    }
    hn::Store(value, d, tile.value + i);
    if (kGradient)
      hn::Store(gx, d, tile.gradient[0] + i), hn::Store(gy, d, tile.gradient[1] + i),
          hn::Store(gz, d, tile.gradient[2] + i);
  }
}

void BlendCorners(const CellCorner* corners, std::size_t count, std::size_t n, bool gradient, bool own,
                  CellTile& tile) {
  if (gradient)
    BlendCornersT<true>(corners, count, n, own, tile);
  else
    BlendCornersT<false>(corners, count, n, own, tile);
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(BlendWeights);
HWY_EXPORT(BlendCorners);

void blend_weights(CellShape shape, std::size_t n, bool gradient, CellTile& tile) {
  HWY_DYNAMIC_DISPATCH(BlendWeights)(shape, n, gradient, tile);
}
void blend_corners(const CellCorner* corners, std::size_t count, std::size_t n, bool gradient, bool own,
                   CellTile& tile) {
  HWY_DYNAMIC_DISPATCH(BlendCorners)(corners, count, n, gradient, own, tile);
}

}  // namespace sansmesh::inline v1::detail
#endif
