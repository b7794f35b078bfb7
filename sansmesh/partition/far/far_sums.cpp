#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/partition/far/far_sums.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>

#include "sansmesh/core/portable-inl.h"
#include "sansmesh/partition/far/far_sums.h"

#ifndef SANSMESH_FAR_SUMS_ONCE
#define SANSMESH_FAR_SUMS_ONCE
namespace sansmesh::inline v1 {
/// Squared distance from a group in squares of its radius: below the first bound its members are summed, beyond the
/// second the group is approximated. Closer up, a group's 1/r⁶ differs so much from that of its members that the
/// transition would be steep.
constexpr float kOpen = 4.0f, kClosed = 5.0f;
/// The same for rough sums, without a transition.
constexpr float kRough = 2.25f;
}  // namespace sansmesh::inline v1
#endif

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace pn = portable::HWY_NAMESPACE;

/// Terms of a group or a patch at a vector of points in the sums of FarBatch, and their gradients.
template <class V>
struct FarTerms {
  V term[3], slope[3][3];
};

/// Common quantities: the vector to the source, 1 / r and its squares, and the source's constants.
template <class D>
struct FarView {
  using V = hn::Vec<D>;
  D d;
  V step[3], root;
  const FarTree::Octet& octet;
  std::size_t k;

  V constant(const float (&row)[kTreeWidth]) const { return hn::Set(d, row[k]); }
  /// Product of a symmetric matrix, given by its six entries, and a vector.
  static void times(const V (&m)[6], const V (&v)[3], V (&product)[3]) {
    product[0] = pn::MulAdd(m[0], v[0], pn::MulAdd(m[1], v[1], hn::Mul(m[2], v[2])));
    product[1] = pn::MulAdd(m[1], v[0], pn::MulAdd(m[3], v[1], hn::Mul(m[4], v[2])));
    product[2] = pn::MulAdd(m[2], v[0], pn::MulAdd(m[4], v[1], hn::Mul(m[5], v[2])));
  }
  static V dot(const V (&a)[3], const V (&b)[3]) {
    return pn::MulAdd(a[0], b[0], pn::MulAdd(a[1], b[1], hn::Mul(a[2], b[2])));
  }
};

/// Terms of a patch.
template <bool kGradient, FarSums kSums, class D, class V = hn::Vec<D>>
HWY_INLINE void PatchTerms(const FarView<D>& at, FarTerms<V>& found) {
  const D d = at.d;
  const V area = at.constant(at.octet.area);
  const V normal[3] = {at.constant(at.octet.ax), at.constant(at.octet.ay), at.constant(at.octet.az)};
  const V square = hn::Mul(at.root, at.root), cube = hn::Mul(at.root, square), sixth = hn::Mul(cube, cube);
  const V pull_of_dipole = kSums == FarSums::open ? sixth : cube;
  found.term[0] = hn::Mul(at.dot(at.step, normal), pull_of_dipole);
  found.term[1] = hn::Mul(area, hn::Mul(square, square)), found.term[2] = hn::Mul(area, sixth);
  if (!kGradient) return;
  constexpr float kPower[3] = {kSums == FarSums::open ? 6 : 3, 4, 6};  // ∇ 1/rⁿ = n/rⁿ⁺² (p − x)
  for (std::size_t m = 0; m < 3; ++m) {
    const V pull = hn::Mul(hn::Mul(hn::Set(d, kPower[m]), square), found.term[m]);
    for (std::size_t a = 0; a < 3; ++a) found.slope[m][a] = hn::Mul(pull, at.step[a]);
  }
  for (std::size_t a = 0; a < 3; ++a) found.slope[0][a] = pn::NegMulAdd(pull_of_dipole, normal[a], found.slope[0][a]);
}

/// Terms of a group, Σ ⟨s + d, a⟩ / |s + d|ⁿ for its position s and members at s + d, up to second order in d: with u =
/// s / r and the moments M, T and t of Moments it is
/// (⟨u, Σa⟩ + (tr M − n ⟨u, Mu⟩) / r + n/2 ((n + 2) T(u, u, u) − ⟨u, t⟩) / r²) / rⁿ⁻¹.
template <bool kGradient, FarSums kSums, class D, class V = hn::Vec<D>>
HWY_INLINE void GroupDipole(const FarView<D>& at, const FarTree::Moments& moments, const V (&u)[3],
                            FarTerms<V>& found) {
  constexpr float n = kSums == FarSums::open ? 6 : 3;
  const D d = at.d;
  V m[6], t[10], along[6], mu[3], tuu[3];
  for (std::size_t i = 0; i < 6; ++i) m[i] = at.constant(moments.first[i]);
  for (std::size_t i = 0; i < 10; ++i) t[i] = at.constant(moments.second[i]);
  // T(u, ·, ·): the rows of T that belong to each of the entries.
  constexpr std::size_t kRow[6][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}, {3, 6, 7}, {4, 7, 8}, {5, 8, 9}};
  for (std::size_t i = 0; i < 6; ++i)
    along[i] = pn::MulAdd(t[kRow[i][0]], u[0], pn::MulAdd(t[kRow[i][1]], u[1], hn::Mul(t[kRow[i][2]], u[2])));
  at.times(m, u, mu), at.times(along, u, tuu);
  const V all[3] = {at.constant(at.octet.ax), at.constant(at.octet.ay), at.constant(at.octet.az)};
  const V turned[3] = {at.constant(moments.turned[0]), at.constant(moments.turned[1]), at.constant(moments.turned[2])};
  const V trace = hn::Add(hn::Add(m[0], m[3]), m[5]);
  const V zeroth = at.dot(u, all), first = at.dot(u, mu), second = at.dot(u, tuu), round = at.dot(u, turned);
  const V root = at.root, square = hn::Mul(root, root);
  const V power = kSums == FarSums::open ? hn::Mul(hn::Mul(square, square), root) : square;  // 1 / rⁿ⁻¹
  const V half = hn::Set(d, 0.5f * n);
  const V inner = pn::MulAdd(hn::Mul(root, half), pn::MulSub(hn::Set(d, n + 2), second, round),
                             pn::NegMulAdd(hn::Set(d, n), first, trace));
  found.term[0] = hn::Mul(power, pn::MulAdd(root, inner, zeroth));
  if (!kGradient) return;
  // −∂/∂s: the part along u, and the rest.
  const V outer = pn::MulAdd(hn::Mul(root, hn::Set(d, 0.5f * (n + 2))), pn::MulSub(hn::Set(d, n + 4), second, round),
                             pn::NegMulAdd(hn::Set(d, n + 2), first, trace));
  const V away = hn::Mul(hn::Set(d, n), pn::MulAdd(root, outer, zeroth)), fall = hn::Mul(power, root);
  for (std::size_t a = 0; a < 3; ++a) {
    const V bent = hn::Mul(hn::Mul(root, half), pn::MulSub(hn::Set(d, 3 * (n + 2)), tuu[a], turned[a]));
    const V rest = pn::MulAdd(root, pn::NegMulAdd(hn::Set(d, 2 * n), mu[a], bent), all[a]);
    found.slope[0][a] = hn::Mul(fall, pn::MulSub(u[a], away, rest));
  }
}

/// Σ w / |s + d|ᵐ of a group for m = 4 and 6, likewise: with S and z of Moments (Σw + m/2 ((m + 2) ⟨u, Su⟩ − z) / r²) /
/// rᵐ. The position is the weighted centre, so that the first order vanishes.
template <bool kGradient, FarSums kSums, class D, class V = hn::Vec<D>>
HWY_INLINE void GroupWeights(const FarView<D>& at, const FarTree::Moments& moments, const V (&u)[3],
                             FarTerms<V>& found) {
  const D d = at.d;
  V s[6], su[3];
  for (std::size_t i = 0; i < 6; ++i) s[i] = at.constant(moments.spread[i]);
  at.times(s, u, su);
  const V weight = at.constant(at.octet.area), size = at.constant(moments.size), spread = at.dot(u, su);
  const V square = hn::Mul(at.root, at.root);
  for (std::size_t i = kSums == FarSums::open ? 2 : 1; i < 3; ++i) {
    const float m = i == 1 ? 4 : 6;
    const V power = hn::Mul(hn::Mul(square, square), i == 1 ? hn::Set(d, 1.0f) : square);
    const V half = hn::Mul(square, hn::Set(d, 0.5f * m));
    found.term[i] = hn::Mul(power, pn::MulAdd(half, pn::MulSub(hn::Set(d, m + 2), spread, size), weight));
    if (!kGradient) continue;
    const V outer = hn::Mul(square, hn::Set(d, 0.5f * (m + 2)));
    const V away = hn::Mul(hn::Set(d, m), pn::MulAdd(outer, pn::MulSub(hn::Set(d, m + 4), spread, size), weight));
    const V across = hn::Mul(half, hn::Set(d, 2 * (m + 2))), fall = hn::Mul(power, at.root);
    for (std::size_t a = 0; a < 3; ++a)
      found.slope[i][a] = hn::Mul(fall, pn::MulSub(u[a], away, hn::Mul(across, su[a])));
  }
}

template <bool kGradient, FarSums kSums, class D, class V = hn::Vec<D>>
HWY_INLINE void GroupTerms(const FarView<D>& at, const FarTree::Moments& moments, FarTerms<V>& found) {
  const V u[3] = {hn::Mul(at.step[0], at.root), hn::Mul(at.step[1], at.root), hn::Mul(at.step[2], at.root)};
  GroupDipole<kGradient, kSums>(at, moments, u, found);
  if (kSums != FarSums::winding) GroupWeights<kGradient, kSums>(at, moments, u, found);
}

/// Adds the terms of a source with the points' shares in it.
template <bool kGradient, FarSums kSums, class V>
HWY_INLINE void AddTerms(const FarTerms<V>& found, const V& share, const V (&share_slope)[3], FarTerms<V>& sum) {
  for (std::size_t m = 0; m < 3; ++m) {
    if (m > 0 && kSums == FarSums::winding) break;
    if (m == 1 && kSums == FarSums::open) continue;
    sum.term[m] = pn::MulAdd(share, found.term[m], sum.term[m]);
    if (!kGradient) continue;
    for (std::size_t a = 0; a < 3; ++a)
      sum.slope[m][a] =
          pn::MulAdd(share_slope[a], found.term[m], pn::MulAdd(share, found.slope[m][a], sum.slope[m][a]));
  }
}

/// Sums over all patches at up to kBatch points: Σ ⟨p − x, a⟩ / r³ (/ r⁶ for open ones), Σ area / r⁴, Σ area / r⁶ (and
/// their gradients if kGradient), as selected by kSums. A group is approximated beyond about twice its radius; near
/// that distance it blends smoothly into its members, so that the sums are continuous. All points traverse the tree
/// together, each with its own share in every group, so that the result at one point does not depend on the others.
template <bool kGradient, FarSums kSums>
void SumSourcesT(const FarTree& tree, FarBatch& batch, std::size_t begin) {
  constexpr std::size_t kLanes = 16, kStack = 256;
  const hn::CappedTag<float, kLanes> d;
  using D = hn::CappedTag<float, kLanes>;
  using V = hn::Vec<D>;
  struct Item {
    std::uint32_t level, octet;
  };
  Item stack[kStack];
  // For each item on the stack, the points' shares in it and, if kGradient, their gradients.
  HWY_ALIGN float shares[kStack][kLanes];
  HWY_ALIGN float slopes[kGradient ? kStack : 1][3][kLanes];
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const V p[3] = {hn::LoadU(d, batch.x[0] + begin), hn::LoadU(d, batch.x[1] + begin), hn::LoadU(d, batch.x[2] + begin)};
  FarTerms<V> sum{{zero, zero, zero}, {{zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}}}, found = sum;
  std::size_t top = 1;
  stack[0] = {static_cast<std::uint32_t>(tree.levels.size() - 1), 0};
  hn::Store(one, d, shares[0]);
  if (kGradient)
    for (float* lane : slopes[0]) hn::Store(zero, d, lane);
  while (top > 0) {
    const Item item = stack[--top];
    const FarTree::Octet& o = tree.levels[item.level][item.octet];
    const V whole = hn::Load(d, shares[top]);
    V whole_slope[3] = {zero, zero, zero};
    if (kGradient)
      for (std::size_t a = 0; a < 3; ++a) whole_slope[a] = hn::Load(d, slopes[top][a]);
    for (std::uint32_t k = 0; k < 8; ++k) {
      if (o.radius[k] < 0) continue;
      FarView<D> at{
          d,
          {hn::Sub(hn::Set(d, o.x[k]), p[0]), hn::Sub(hn::Set(d, o.y[k]), p[1]), hn::Sub(hn::Set(d, o.z[k]), p[2])},
          one,
          o,
          k};
      V r2 = at.dot(at.step, at.step);
      V share = whole, share_slope[3] = {whole_slope[0], whole_slope[1], whole_slope[2]};
      if (item.level > 0) {
        const float inverse = 1 / (std::max(o.radius[k] * o.radius[k], 1e-20f) * (kClosed - kOpen));
        const V t = pn::MulAdd(r2, hn::Set(d, inverse), hn::Set(d, -kOpen / (kClosed - kOpen)));
        const auto open = hn::And(hn::Lt(t, one), hn::Gt(whole, zero));
        if (!hn::AllFalse(d, open)) {
          // The group's share grows from 0 to 1 with t; the rest belongs to its members.
          const V u = hn::Min(hn::Max(t, zero), one);
          const V part = hn::Mul(hn::Mul(u, u), pn::NegMulAdd(hn::Set(d, 2.0f), u, hn::Set(d, 3.0f)));
          share = hn::Mul(whole, part);
          stack[top] = {item.level - 1, item.octet * 8 + k};
          hn::Store(hn::Sub(whole, share), d, shares[top]);
          if (kGradient) {
            const V turn = hn::Mul(hn::Mul(whole, hn::Mul(u, hn::Sub(one, u))), hn::Set(d, -12 * inverse));
            for (std::size_t a = 0; a < 3; ++a) {
              share_slope[a] = pn::MulAdd(turn, at.step[a], hn::Mul(whole_slope[a], part));
              hn::Store(hn::Sub(whole_slope[a], share_slope[a]), d, slopes[top][a]);
            }
          }
          ++top;
          if (hn::AllTrue(d, hn::Le(share, zero))) continue;
        }
      } else {
        // A patch is a disc, not a point: it is softened within its radius.
        r2 = hn::Add(r2, hn::Set(d, 0.25f * o.area[k]));
      }
      r2 = hn::IfThenElse(hn::Gt(share, zero), hn::Max(r2, hn::Set(d, 1e-12f)), one);
      at.root = pn::ReciprocalSqrt(r2);
      if (item.level == 0)
        PatchTerms<kGradient, kSums>(at, found);
      else
        GroupTerms<kGradient, kSums>(at, tree.moments[item.level - 1][item.octet], found);
      AddTerms<kGradient, kSums>(found, share, share_slope, sum);
    }
  }
  for (std::size_t m = 0; m < 3; ++m) hn::StoreU(sum.term[m], d, batch.sum[m] + begin);
  if (kGradient)
    for (std::size_t m = 0; m < 3; ++m)
      for (std::size_t a = 0; a < 3; ++a) hn::StoreU(sum.slope[m][a], d, batch.slope[m][a] + begin);
}

void SumSources(const FarTree& tree, FarSums sums, bool gradient, std::size_t count, FarBatch& batch) {
  const std::size_t lanes = hn::Lanes(hn::CappedTag<float, 16>());
  for (std::size_t i = 0; i < count; i += lanes) {
    if (sums == FarSums::winding) {
      SumSourcesT<false, FarSums::winding>(tree, batch, i);
    } else if (sums == FarSums::open) {
      gradient ? SumSourcesT<true, FarSums::open>(tree, batch, i) : SumSourcesT<false, FarSums::open>(tree, batch, i);
    } else {
      gradient ? SumSourcesT<true, FarSums::closed>(tree, batch, i)
               : SumSourcesT<false, FarSums::closed>(tree, batch, i);
    }
  }
}

/// Σ ⟨p − x, a⟩ / r³ without moments and transitions; of open patches Σ ⟨p − x, a⟩ / r⁶, Σ area / r⁵ and Σ area / r⁶.
template <bool kOpenPatches>
void SumRoughlyT(const FarTree& tree, FarBatch& batch, std::size_t begin) {
  constexpr std::size_t kLanes = 16, kStack = 256;
  const hn::CappedTag<float, kLanes> d;
  using V = hn::Vec<decltype(d)>;
  struct Item {
    std::uint32_t level, octet;
  };
  Item stack[kStack];
  HWY_ALIGN float shares[kStack][kLanes];  // 1 for the points that look at the item
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), quarter = hn::Set(d, 0.25f), least = hn::Set(d, 1e-12f);
  const V p[3] = {hn::LoadU(d, batch.x[0] + begin), hn::LoadU(d, batch.x[1] + begin), hn::LoadU(d, batch.x[2] + begin)};
  V sum = zero, fifths = zero, sixths = zero;
  std::size_t top = 1;
  stack[0] = {static_cast<std::uint32_t>(tree.levels.size() - 1), 0};
  hn::Store(one, d, shares[0]);
  while (top > 0) {
    const Item item = stack[--top];
    const FarTree::Octet& o = tree.levels[item.level][item.octet];
    const V whole = hn::Load(d, shares[top]);
    for (std::uint32_t k = 0; k < 8; ++k) {
      if (o.radius[k] < 0) continue;
      const V x = hn::Sub(hn::Set(d, o.x[k]), p[0]), y = hn::Sub(hn::Set(d, o.y[k]), p[1]),
              z = hn::Sub(hn::Set(d, o.z[k]), p[2]);
      V r2 = pn::MulAdd(x, x, pn::MulAdd(y, y, hn::Mul(z, z))), share = whole;
      if (item.level > 0) {
        const auto near = hn::Lt(r2, hn::Set(d, kRough * o.radius[k] * o.radius[k]));
        const V below = hn::IfThenElseZero(near, whole);
        if (!hn::AllTrue(d, hn::Eq(below, zero))) {
          stack[top] = {item.level - 1, item.octet * 8 + k};
          hn::Store(below, d, shares[top++]);
          share = hn::Sub(whole, below);
          if (hn::AllTrue(d, hn::Eq(share, zero))) continue;
        }
      } else {
        r2 = pn::MulAdd(quarter, hn::Set(d, o.area[k]), r2);
      }
      const V root = pn::ReciprocalSqrt(hn::Max(r2, least)), cube = hn::Mul(root, hn::Mul(root, root));
      const V along =
          pn::MulAdd(x, hn::Set(d, o.ax[k]), pn::MulAdd(y, hn::Set(d, o.ay[k]), hn::Mul(z, hn::Set(d, o.az[k]))));
      if (kOpenPatches) {
        const V fifth = hn::Mul(hn::Mul(share, cube), hn::Mul(root, root)), sixth = hn::Mul(fifth, root);
        sum = pn::MulAdd(sixth, along, sum);
        fifths = pn::MulAdd(fifth, hn::Set(d, o.area[k]), fifths);
        sixths = pn::MulAdd(sixth, hn::Set(d, o.area[k]), sixths);
      } else {
        sum = pn::MulAdd(hn::Mul(share, along), cube, sum);
      }
    }
  }
  hn::StoreU(sum, d, batch.sum[0] + begin);
  if (kOpenPatches) hn::StoreU(fifths, d, batch.sum[1] + begin), hn::StoreU(sixths, d, batch.sum[2] + begin);
}

void SumRoughly(const FarTree& tree, bool open, std::size_t count, FarBatch& batch) {
  const std::size_t lanes = hn::Lanes(hn::CappedTag<float, 16>());
  for (std::size_t i = 0; i < count; i += lanes)
    open ? SumRoughlyT<true>(tree, batch, i) : SumRoughlyT<false>(tree, batch, i);
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1 {
HWY_EXPORT(SumSources);
HWY_EXPORT(SumRoughly);

void sum_sources(const FarTree& tree, FarSums sums, bool gradient, std::size_t count, FarBatch& batch) {
  HWY_DYNAMIC_DISPATCH(SumSources)(tree, sums, gradient, count, batch);
}

void sum_roughly(const FarTree& tree, bool open, std::size_t count, FarBatch& batch) {
  HWY_DYNAMIC_DISPATCH(SumRoughly)(tree, open, count, batch);
}

}  // namespace sansmesh::inline v1
#endif
