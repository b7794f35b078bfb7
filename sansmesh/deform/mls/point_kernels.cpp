#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/deform/mls/point_kernels.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <limits>

#include "sansmesh/deform/mls/point_kernels.h"
#include "sansmesh/deform/mls/rotation_lanes-inl.h"
#include "sansmesh/deform/mls/weight_power-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1::detail {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DoubleTag = hn::CappedTag<double, 8>;
using DoubleV = hn::Vec<DoubleTag>;

constexpr std::size_t kWidest = 8;

/// A vector of points, with the nearest handle of each. All positions are relative to that handle: this avoids
/// cancellation if it is much heavier than the rest, and moments need not be taken about the means.
struct SeenHandles {
  const PointMap& map;
  double* weights;       ///< handle h: [lanes h]; before weighting, squared distances
  const double* extras;  ///< handle h at the first of the points: [stride h]; or null
  std::size_t stride;
  DoubleV x[3], nearest_q[3], nearest_p[3], least, total, mean_q[3], mean_p[3];

  SeenHandles(const PointMap& m, double* w, const double* e, std::size_t s)
      : map(m), weights(w), extras(e), stride(s) {}
  std::size_t count() const { return map.weight.size(); }
  DoubleV kept(std::size_t h) const { return hn::Load(DoubleTag(), weights + h * hn::Lanes(DoubleTag())); }
  DoubleV near_q(std::size_t h, std::size_t k) const {
    return hn::Sub(hn::Set(DoubleTag(), map.q[k][h]), nearest_q[k]);
  }
  DoubleV near_p(std::size_t h, std::size_t k) const {
    return hn::Sub(hn::Set(DoubleTag(), map.p[k][h]), nearest_p[k]);
  }
  DoubleV hat_q(std::size_t h, std::size_t k) const { return hn::Sub(near_q(h, k), mean_q[k]); }
  DoubleV hat_p(std::size_t h, std::size_t k) const { return hn::Sub(near_p(h, k), mean_p[k]); }
  DoubleV hat_x(std::size_t k) const { return hn::Sub(hn::Sub(x[k], nearest_q[k]), mean_q[k]); }
};

/// The nearest handles, and the squared distances from all handles.
HWY_INLINE void FindNearest(SeenHandles& seen) {
  const DoubleTag d;
  const std::size_t lanes = hn::Lanes(d);
  seen.least = hn::Set(d, std::numeric_limits<double>::max());
  for (std::size_t k = 0; k < 3; ++k) {
    seen.nearest_q[k] = hn::Set(d, seen.map.q[k][0]), seen.nearest_p[k] = hn::Set(d, seen.map.p[k][0]);
  }
  for (std::size_t h = 0; h < seen.count(); ++h) {
    const DoubleV q[3] = {hn::Set(d, seen.map.q[0][h]), hn::Set(d, seen.map.q[1][h]), hn::Set(d, seen.map.q[2][h])};
    const DoubleV to[3] = {hn::Sub(seen.x[0], q[0]), hn::Sub(seen.x[1], q[1]), hn::Sub(seen.x[2], q[2])};
    const DoubleV square = Sum3(hn::Mul(to[0], to[0]), hn::Mul(to[1], to[1]), hn::Mul(to[2], to[2]));
    hn::Store(square, d, seen.weights + h * lanes);
    const auto nearer = hn::Lt(square, seen.least);
    seen.least = hn::Min(square, seen.least);
    for (std::size_t k = 0; k < 3; ++k) {
      seen.nearest_q[k] = hn::IfThenElse(nearer, q[k], seen.nearest_q[k]);
      seen.nearest_p[k] = hn::IfThenElse(nearer, hn::Set(d, seen.map.p[k][h]), seen.nearest_p[k]);
    }
  }
}

/// The weight of a handle, from its distance relative to the nearest.
HWY_INLINE DoubleV WeightOf(const SeenHandles& seen, std::size_t h, const DoubleV& unit, const DoubleV& floor) {
  const DoubleTag d;
  const DoubleV square = hn::Max(seen.kept(h), floor);
  const DoubleV w = hn::Mul(hn::Set(d, seen.map.weight[h]), WeightPower(hn::Div(unit, square), seen.map.alpha));
  if (!seen.extras) return w;
  const DoubleV extra = hn::Mul(hn::Set(d, seen.map.damping), hn::LoadU(d, seen.extras + h * seen.stride));
  const DoubleV distance = hn::Sqrt(square);
  return hn::Mul(w, hn::Div(distance, hn::Add(distance, extra)));
}

HWY_INLINE void ClearMeans(SeenHandles& seen) {
  seen.total = hn::Zero(DoubleTag());
  for (std::size_t k = 0; k < 3; ++k) seen.mean_q[k] = seen.mean_p[k] = seen.total;
}

/// Sums over the handles about the weighted means: Σ w p qᵀ and, if needed, Σ w q qᵀ (xx xy xz yy yz zz).
struct Moments {
  // Not implicit: an implicit constructor is compiled for no particular instruction set, which ARM rejects.
  HWY_ATTR Moments() {}
  DoubleV pq[3][3], qq[6];
};

/// `kSquares`: 0 none, 1 their sum in qq[0], 6 all.
template <int kSquares>
HWY_INLINE Moments SumMoments(SeenHandles& seen) {
  const DoubleTag d;
  const DoubleV floor = hn::Set(d, seen.map.floor_square), unit = hn::Max(seen.least, floor), zero = hn::Zero(d);
  ClearMeans(seen);
  Moments m;
  for (auto& row : m.pq)
    for (DoubleV& e : row) e = zero;
  for (DoubleV& e : m.qq) e = zero;
  for (std::size_t h = 0; h < seen.count(); ++h) {
    const DoubleV w = WeightOf(seen, h, unit, floor);
    const DoubleV q[3] = {seen.near_q(h, 0), seen.near_q(h, 1), seen.near_q(h, 2)};
    const DoubleV wq[3] = {hn::Mul(w, q[0]), hn::Mul(w, q[1]), hn::Mul(w, q[2])};
    seen.total = hn::Add(seen.total, w);
    for (std::size_t i = 0; i < 3; ++i) {
      const DoubleV p = seen.near_p(h, i);
      seen.mean_q[i] = hn::Add(seen.mean_q[i], wq[i]);
      seen.mean_p[i] = hn::Add(seen.mean_p[i], hn::Mul(w, p));
      for (std::size_t j = 0; j < 3; ++j) m.pq[i][j] = hn::Add(m.pq[i][j], hn::Mul(p, wq[j]));
    }
    if constexpr (kSquares == 1)
      m.qq[0] = hn::Add(m.qq[0], Sum3(hn::Mul(q[0], wq[0]), hn::Mul(q[1], wq[1]), hn::Mul(q[2], wq[2])));
    if constexpr (kSquares == 6) {
      for (std::size_t i = 0, e = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j, ++e) m.qq[e] = hn::Add(m.qq[e], hn::Mul(q[i], wq[j]));
    }
  }
  const DoubleV share = hn::Div(hn::Set(d, 1.0), seen.total);
  const DoubleV sum_q[3] = {seen.mean_q[0], seen.mean_q[1], seen.mean_q[2]};
  for (std::size_t i = 0; i < 3; ++i)
    seen.mean_q[i] = hn::Mul(seen.mean_q[i], share), seen.mean_p[i] = hn::Mul(seen.mean_p[i], share);
  for (std::size_t i = 0, e = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) m.pq[i][j] = hn::Sub(m.pq[i][j], hn::Mul(seen.mean_p[i], sum_q[j]));
    if constexpr (kSquares == 1) m.qq[0] = hn::Sub(m.qq[0], hn::Mul(seen.mean_q[i], sum_q[i]));
    if constexpr (kSquares == 6) {
      for (std::size_t j = i; j < 3; ++j, ++e) m.qq[e] = hn::Sub(m.qq[e], hn::Mul(seen.mean_q[i], sum_q[j]));
    }
  }
  return m;
}

/// Replaces squared distances by weights, and computes the means.
HWY_INLINE void WeighHandles(SeenHandles& seen) {
  const DoubleTag d;
  const DoubleV floor = hn::Set(d, seen.map.floor_square), unit = hn::Max(seen.least, floor);
  ClearMeans(seen);
  for (std::size_t h = 0; h < seen.count(); ++h) {
    const DoubleV w = WeightOf(seen, h, unit, floor);
    hn::Store(w, d, seen.weights + h * hn::Lanes(d));
    seen.total = hn::Add(seen.total, w);
    for (std::size_t k = 0; k < 3; ++k) {
      seen.mean_q[k] = hn::Add(seen.mean_q[k], hn::Mul(w, seen.near_q(h, k)));
      seen.mean_p[k] = hn::Add(seen.mean_p[k], hn::Mul(w, seen.near_p(h, k)));
    }
  }
  const DoubleV share = hn::Div(hn::Set(d, 1.0), seen.total);
  for (std::size_t k = 0; k < 3; ++k)
    seen.mean_q[k] = hn::Mul(seen.mean_q[k], share), seen.mean_p[k] = hn::Mul(seen.mean_p[k], share);
}

HWY_INLINE void Apply(const DoubleV (&a)[3][3], const DoubleV (&v)[3], DoubleV (&moved)[3]) {
  for (std::size_t i = 0; i < 3; ++i)
    moved[i] = Sum3(hn::Mul(a[i][0], v[0]), hn::Mul(a[i][1], v[1]), hn::Mul(a[i][2], v[2]));
}

/// The fitted rotation, applied to x minus the mean.
HWY_INLINE void FitRotation(SeenHandles& seen, DoubleV (&moved)[3]) {
  const Moments m = SumMoments<0>(seen);
  DoubleV r[3][3];
  BestRotation(m.pq, r);
  Apply(r, {seen.hat_x(0), seen.hat_x(1), seen.hat_x(2)}, moved);
}

/// The fitted rotation and scale.
HWY_INLINE void FitSimilarity(SeenHandles& seen, DoubleV (&moved)[3]) {
  const DoubleTag d;
  const Moments m = SumMoments<1>(seen);
  DoubleV r[3][3], aligned = hn::Zero(d);
  BestRotation(m.pq, r);
  Apply(r, {seen.hat_x(0), seen.hat_x(1), seen.hat_x(2)}, moved);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) aligned = hn::Add(aligned, hn::Mul(r[i][j], m.pq[i][j]));
  const auto some = hn::Gt(m.qq[0], hn::Zero(d));
  const DoubleV one = hn::Set(d, 1.0);
  const DoubleV scale = hn::IfThenElse(some, hn::Div(aligned, hn::IfThenElse(some, m.qq[0], one)), one);
  for (DoubleV& v : moved) v = hn::Mul(v, scale);
}

HWY_INLINE void EvaluateTerms(const PolynomialTerms& terms, const DoubleV (&v)[3], DoubleV* values) {
  const DoubleTag d;
  DoubleV m[kMostMonomials] = {v[0], v[1], v[2]};
  for (std::size_t j = 3; j < terms.monomials; ++j)
    m[j] = hn::Mul(m[kMonomialSteps[j - 3].variable], m[kMonomialSteps[j - 3].monomial]);
  for (std::size_t j = 0; j < terms.count; ++j) {
    const PolynomialTerm& term = terms.terms[j];
    values[j] = m[term.monomial[0]];
    if (term.parts == 1) continue;
    values[j] = hn::Mul(values[j], hn::Set(d, term.factor[0]));
    for (std::size_t k = 1; k < term.parts; ++k)
      values[j] = hn::Add(values[j], hn::Mul(m[term.monomial[k]], hn::Set(d, term.factor[k])));
  }
}

/// Columns of polynomials times √w on the handles, and their values at a vector of points.
struct Columns {
  std::size_t handles, lanes;
  double *values, *roots;  ///< column j at handle h: [(handles j + h) lanes]; √w: [h lanes]
  DoubleV here[kMostMonomials];

  double* at(std::size_t j, std::size_t h) const { return values + (j * handles + h) * lanes; }
  DoubleV value(std::size_t j, std::size_t h) const { return hn::Load(DoubleTag(), at(j, h)); }
  DoubleV root(std::size_t h) const { return hn::Load(DoubleTag(), roots + h * lanes); }
  DoubleV square(std::size_t j) const {
    DoubleV sum = hn::Zero(DoubleTag());
    for (std::size_t h = 0; h < handles; ++h) sum = hn::Add(sum, hn::Mul(value(j, h), value(j, h)));
    return sum;
  }
};

/// Orthogonalises column j against the constant (coordinates already are, relative to their means) and all earlier
/// columns, at points of the mask.
template <class Mask>
HWY_INLINE void TakeOut(Columns& c, std::size_t j, const DoubleV& over_total, const Mask& mask) {
  const DoubleTag d;
  if (j >= 3) {
    DoubleV mean = hn::Zero(d);
    for (std::size_t h = 0; h < c.handles; ++h) mean = hn::Add(mean, hn::Mul(c.root(h), c.value(j, h)));
    mean = hn::IfThenElseZero(mask, hn::Mul(mean, over_total));
    c.here[j] = hn::Sub(c.here[j], mean);
    for (std::size_t h = 0; h < c.handles; ++h)
      hn::Store(hn::Sub(c.value(j, h), hn::Mul(mean, c.root(h))), d, c.at(j, h));
  }
  for (std::size_t l = 0; l < j; ++l) {
    DoubleV share = hn::Zero(d);
    for (std::size_t h = 0; h < c.handles; ++h) share = hn::Add(share, hn::Mul(c.value(l, h), c.value(j, h)));
    share = hn::IfThenElseZero(mask, share);
    c.here[j] = hn::Sub(c.here[j], hn::Mul(share, c.here[l]));
    for (std::size_t h = 0; h < c.handles; ++h)
      hn::Store(hn::Sub(c.value(j, h), hn::Mul(share, c.value(l, h))), d, c.at(j, h));
  }
}

/// The fitted polynomials at x minus the mean: Σ w p K(x, q) with the kernel K of polynomials orthonormal on the
/// handles. `scratch` holds as many vectors as handles times one more than terms.
HWY_INLINE void FitPolynomials(SeenHandles& seen, double* scratch, DoubleV (&moved)[3]) {
  const DoubleTag d;
  WeighHandles(seen);
  const std::size_t count = seen.count(), terms = seen.map.terms.count;
  Columns c{count, hn::Lanes(d), scratch + count * hn::Lanes(d), scratch, {}};
  const DoubleV unit = hn::Set(d, seen.map.unit), zero = hn::Zero(d), one = hn::Set(d, 1.0);
  DoubleV values[kMostMonomials];
  for (std::size_t h = 0; h < count; ++h) {
    const DoubleV v[3] = {hn::Mul(seen.hat_q(h, 0), unit), hn::Mul(seen.hat_q(h, 1), unit),
                          hn::Mul(seen.hat_q(h, 2), unit)};
    EvaluateTerms(seen.map.terms, v, values);
    const DoubleV root = hn::Sqrt(seen.kept(h));
    hn::Store(root, d, c.roots + h * c.lanes);
    for (std::size_t j = 0; j < terms; ++j) hn::Store(hn::Mul(values[j], root), d, c.at(j, h));
  }
  const DoubleV y[3] = {hn::Mul(seen.hat_x(0), unit), hn::Mul(seen.hat_x(1), unit), hn::Mul(seen.hat_x(2), unit)};
  EvaluateTerms(seen.map.terms, y, c.here);
  const DoubleV over_total = hn::Div(one, seen.total);
  for (std::size_t j = 0; j < terms; ++j) {
    const DoubleV before = c.square(j);
    TakeOut(c, j, over_total, hn::Eq(before, before));
    DoubleV left = c.square(j);
    // Reorthogonalise where little remains: the rounding error of the subtracted part dominates.
    const auto again = hn::Lt(left, hn::Mul(before, hn::Set(d, 1e-3)));
    if (!hn::AllFalse(d, again)) TakeOut(c, j, over_total, again), left = c.square(j);
    const auto keep = hn::And(hn::Gt(left, zero), hn::Gt(left, hn::Mul(before, hn::Set(d, 1e-20))));
    const DoubleV scale = hn::IfThenElseZero(keep, hn::Div(one, hn::Sqrt(hn::IfThenElse(keep, left, one))));
    c.here[j] = hn::Mul(c.here[j], scale);
    for (std::size_t h = 0; h < count; ++h) hn::Store(hn::Mul(c.value(j, h), scale), d, c.at(j, h));
  }
  for (DoubleV& v : moved) v = zero;
  for (std::size_t h = 0; h < count; ++h) {
    DoubleV kernel = zero;
    for (std::size_t j = 0; j < terms; ++j) kernel = hn::Add(kernel, hn::Mul(c.here[j], c.value(j, h)));
    kernel = hn::Mul(kernel, c.root(h));
    for (std::size_t k = 0; k < 3; ++k) moved[k] = hn::Add(moved[k], hn::Mul(kernel, seen.hat_p(h, k)));
  }
}

/// The affine map by the normal equations, or by orthogonal polynomials where these lose too many digits.
HWY_INLINE void FitAffine(SeenHandles& seen, double* scratch, DoubleV (&moved)[3]) {
  const DoubleTag d;
  const Moments m = SumMoments<6>(seen);
  const DoubleV a = m.qq[0], b = m.qq[1], c = m.qq[2], e = m.qq[3], f = m.qq[4], g = m.qq[5];
  // Cofactors: the solution is (cofactors y) / det.
  const DoubleV c00 = hn::Sub(hn::Mul(e, g), hn::Mul(f, f)), c11 = hn::Sub(hn::Mul(a, g), hn::Mul(c, c));
  const DoubleV c22 = hn::Sub(hn::Mul(a, e), hn::Mul(b, b)), c01 = hn::Sub(hn::Mul(c, f), hn::Mul(b, g));
  const DoubleV c02 = hn::Sub(hn::Mul(b, f), hn::Mul(c, e)), c12 = hn::Sub(hn::Mul(b, c), hn::Mul(a, f));
  const DoubleV det = Sum3(hn::Mul(a, c00), hn::Mul(b, c01), hn::Mul(c, c02));
  const DoubleV most = hn::Max(hn::Max(a, e), g);
  const auto good = hn::Gt(det, hn::Mul(hn::Mul(most, most), hn::Mul(most, hn::Set(d, 1e-5))));
  const DoubleV over = hn::IfThenElseZero(good, hn::Div(hn::Set(d, 1.0), hn::IfThenElse(good, det, hn::Set(d, 1.0))));
  const DoubleV y[3] = {seen.hat_x(0), seen.hat_x(1), seen.hat_x(2)};
  DoubleV z[3];
  Apply({{c00, c01, c02}, {c01, c11, c12}, {c02, c12, c22}}, y, z);
  for (DoubleV& v : z) v = hn::Mul(v, over);
  Apply(m.pq, z, moved);
  if (hn::AllTrue(d, good)) return;
  DoubleV careful[3];
  FitPolynomials(seen, scratch, careful);  // computes the same means again
  for (std::size_t k = 0; k < 3; ++k) moved[k] = hn::IfThenElse(good, moved[k], careful[k]);
}

/// Sources of a multiple of the lanes of points, as arrays of coordinates.
void MapTile(const PointMap& map, std::size_t points, const double* const* x, const double* extras,
             double* const* positions, std::vector<double>& scratch) {
  const DoubleTag d;
  const std::size_t lanes = hn::Lanes(d), count = map.weight.size();
  scratch.resize(lanes * count * (2 + map.terms.count) + kWidest);
  double* const weights =
      scratch.data() + (64 - reinterpret_cast<std::uintptr_t>(scratch.data()) % 64) % 64 / sizeof(double);
  const DoubleV rounding = hn::Set(d, 2 * std::numeric_limits<double>::epsilon());
  for (std::size_t i = 0; i < points; i += lanes) {
    SeenHandles seen(map, weights, extras ? extras + i : nullptr, points);
    for (std::size_t k = 0; k < 3; ++k) seen.x[k] = hn::Load(d, x[k] + i);
    FindNearest(seen);
    DoubleV moved[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    switch (map.kind) {
      case DeformationKind::affine:
        FitAffine(seen, weights + lanes * count, moved);
        break;
      case DeformationKind::rigid:
        FitRotation(seen, moved);
        break;
      case DeformationKind::similarity:
        FitSimilarity(seen, moved);
        break;
      case DeformationKind::nonlinear:
        FitPolynomials(seen, weights + lanes * count, moved);
        break;
    }
    DoubleV size = hn::Zero(d);
    for (std::size_t k = 0; k < 3; ++k) size = hn::Max(size, hn::Max(hn::Abs(seen.x[k]), hn::Abs(seen.nearest_q[k])));
    const DoubleV tolerance = hn::Mul(size, rounding);
    const auto held = hn::Le(seen.least, hn::Mul(tolerance, tolerance));
    for (std::size_t k = 0; k < 3; ++k) {
      const DoubleV position = hn::Add(seen.nearest_p[k], hn::Add(seen.mean_p[k], moved[k]));
      hn::Store(hn::IfThenElse(held, seen.nearest_p[k], position), d, positions[k] + i);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1::detail {
HWY_EXPORT(MapTile);

void map_positions(const PointMap& map, std::span<const Vec3> x, std::span<const double> extras,
                   std::span<Vec3> positions) {
  constexpr std::size_t kTile = 256;
  alignas(64) std::array<std::array<double, kTile>, 3> from, to;
  const double* const coordinates[3] = {from[0].data(), from[1].data(), from[2].data()};
  double* const found[3] = {to[0].data(), to[1].data(), to[2].data()};
  std::vector<double> scratch, ways;
  for (std::size_t first = 0; first < x.size(); first += kTile) {
    const std::size_t n = std::min(kTile, x.size() - first), padded = (n + 7) / 8 * 8;
    for (std::size_t i = 0; i < padded; ++i)
      for (std::size_t k = 0; k < 3; ++k) from[k][i] = x[first + std::min(i, n - 1)][k];
    if (!extras.empty()) {
      ways.assign(padded * map.weight.size(), 0);
      for (std::size_t h = 0; h < map.weight.size(); ++h)
        std::copy_n(extras.begin() + static_cast<std::ptrdiff_t>(h * x.size() + first), n,
                    ways.begin() + static_cast<std::ptrdiff_t>(h * padded));
    }
    HWY_DYNAMIC_DISPATCH(MapTile)(map, padded, coordinates, extras.empty() ? nullptr : ways.data(), found, scratch);
    for (std::size_t i = 0; i < n; ++i) positions[first + i] = {to[0][i], to[1][i], to[2][i]};
  }
}

}  // namespace sansmesh::inline v1::detail
#endif
