// SIMD moments and a small scalar Cholesky factorisation for the fits of all degrees.
#include "sansmesh/core/simd_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sansmesh/partition/fit/local_fit.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "sansmesh/partition/fit/local_fit.h"

HWY_BEFORE_NAMESPACE();
namespace sansmesh::inline v1 {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The Gram matrix of the monomials has few distinct entries: the moments Σ weight u^a v^b up to twice the degree, at d
// (d + 1) / 2 + b with d = a + b. Eight partial sums on every target, added in one order, and no fused multiply-add,
// whose rounding would differ from that of instruction sets without it.
template <int Degree>
void Accumulate(const float* u, const float* v, const float* h, const float* w, std::size_t n, double* moments,
                double* rhs, double* squares) {
  constexpr int kM = (2 * Degree + 1) * (2 * Degree + 2) / 2;
  constexpr int kP = (Degree + 1) * (Degree + 2) / 2;
  const hn::CappedTag<double, 8> d;
  const hn::Rebind<float, decltype(d)> df;
  using V = hn::Vec<decltype(d)>;
  HWY_ALIGN double parts[kM + kP + 2][8];
  for (std::size_t begin = 0; begin < 8; begin += hn::Lanes(d)) {
    V m[kM], r[kP];
    for (V& x : m) x = hn::Zero(d);
    for (V& x : r) x = hn::Zero(d);
    V q = hn::Zero(d), w2 = hn::Zero(d);
    for (std::size_t i = begin; i < n; i += 8) {
      const V uu = hn::PromoteTo(d, hn::LoadU(df, u + i)), vv = hn::PromoteTo(d, hn::LoadU(df, v + i)),
              hh = hn::PromoteTo(d, hn::LoadU(df, h + i)), ww = hn::PromoteTo(d, hn::LoadU(df, w + i));
      V power[2 * Degree + 1];
      power[0] = hn::Set(d, 1.0);
      for (int b = 1; b <= 2 * Degree; ++b) power[b] = hn::Mul(power[b - 1], vv);
      const V wh = hn::Mul(ww, hh);
      q = hn::Add(q, hn::Mul(wh, hh));
      w2 = hn::Add(w2, hn::Mul(ww, ww));
      V up = ww, uh = wh;
      for (int a = 0; a <= 2 * Degree; ++a) {
        for (int b = 0; a + b <= 2 * Degree; ++b) {
          const int at = (a + b) * (a + b + 1) / 2 + b;
          m[at] = hn::Add(m[at], hn::Mul(up, power[b]));
          if (a + b <= Degree) r[at] = hn::Add(r[at], hn::Mul(uh, power[b]));
        }
        up = hn::Mul(up, uu);
        uh = hn::Mul(uh, uu);
      }
    }
    for (int k = 0; k < kM; ++k) hn::Store(m[k], d, parts[k] + begin);
    for (int k = 0; k < kP; ++k) hn::Store(r[k], d, parts[kM + k] + begin);
    hn::Store(q, d, parts[kM + kP] + begin), hn::Store(w2, d, parts[kM + kP + 1] + begin);
  }
  const auto total = [](const double* s) { return ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7])); };
  for (int k = 0; k < kM; ++k) moments[k] = total(parts[k]);
  for (int k = 0; k < kP; ++k) rhs[k] = total(parts[kM + k]);
  squares[0] = total(parts[kM + kP]), squares[1] = total(parts[kM + kP + 1]);
}

void AccumulateMoments(int degree, const float* u, const float* v, const float* h, const float* w, std::size_t n,
                       double* moments, double* rhs, double* squares) {
  switch (degree) {
    case 4:
      return Accumulate<4>(u, v, h, w, n, moments, rhs, squares);
    case 3:
      return Accumulate<3>(u, v, h, w, n, moments, rhs, squares);
    case 2:
      return Accumulate<2>(u, v, h, w, n, moments, rhs, squares);
    case 1:
      return Accumulate<1>(u, v, h, w, n, moments, rhs, squares);
    default:
      return Accumulate<0>(u, v, h, w, n, moments, rhs, squares);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sansmesh::inline v1
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sansmesh::inline v1 {
HWY_EXPORT(AccumulateMoments);

namespace {

constexpr int moment_index(int a, int b) {
  const int d = a + b;
  return d * (d + 1) / 2 + b;
}
constexpr int kMoments = 45;
struct Exponent {
  int u, v;
};
constexpr std::array<Exponent, 15> kExponents{{{0, 0},
                                               {1, 0},
                                               {0, 1},
                                               {2, 0},
                                               {1, 1},
                                               {0, 2},
                                               {3, 0},
                                               {2, 1},
                                               {1, 2},
                                               {0, 3},
                                               {4, 0},
                                               {3, 1},
                                               {2, 2},
                                               {1, 3},
                                               {0, 4}}};

/// Moment of the product of two monomials.
constexpr std::array<std::array<std::uint8_t, 15>, 15> kProduct = [] {
  std::array<std::array<std::uint8_t, 15>, 15> table{};
  for (std::size_t a = 0; a < 15; ++a)
    for (std::size_t b = 0; b < 15; ++b)
      table[a][b] =
          static_cast<std::uint8_t>(moment_index(kExponents[a].u + kExponents[b].u, kExponents[a].v + kExponents[b].v));
  return table;
}();

}  // namespace

DegreeFits fit_all_degrees(LocalSamples& samples, int max_degree) {
  DegreeFits fits;
  int degree = std::min(max_degree, kMaxDegree);
  while (degree > 0 && samples.size() < 2 * static_cast<std::size_t>(kBasisSize[static_cast<std::size_t>(degree)]))
    --degree;
  if (samples.size() == 0) return fits;
  samples.pad();
  std::array<double, kMoments> m{};
  std::array<double, 15> rhs{};
  double squares[2] = {};
  HWY_DYNAMIC_DISPATCH(AccumulateMoments)
  (degree, samples.u(), samples.v(), samples.w(), samples.weight(), samples.size(), m.data(), rhs.data(), squares);
  fits.weight_sum = m[0];
  if (!(m[0] > 0)) return fits;
  fits.effective_count = m[0] * m[0] / squares[1];

  // The Cholesky factorisation of the Gram matrix is Gram–Schmidt on the monomials in their order: row a of L makes
  // basis function a orthonormal to the previous ones, so the fit of each degree is a prefix of those above.
  std::array<double, 15> inverse{};  // of the diagonal
  double rest = squares[0];
  int basis = 0;
  for (int d = 0; d <= degree; ++d) {
    for (; basis < kBasisSize[static_cast<std::size_t>(d)]; ++basis) {
      const auto a = static_cast<std::size_t>(basis);
      for (std::size_t b = 0; b < a; ++b) {
        double t = m[kProduct[a][b]];
        for (std::size_t k = 0; k < b; ++k) t -= fits.l[a][k] * fits.l[b][k];
        fits.l[a][b] = t * inverse[b];
      }
      const double own = m[kProduct[a][a]];
      double t = own;
      for (std::size_t k = 0; k < a; ++k) t -= fits.l[a][k] * fits.l[a][k];
      if (!(t > 1e-9 * own) || !(own > 1e-12 * m[0])) return fits;
      fits.l[a][a] = std::sqrt(t);
      inverse[a] = 1 / fits.l[a][a];
      double y = rhs[a];
      for (std::size_t k = 0; k < a; ++k) y -= fits.l[a][k] * fits.y[k];
      fits.y[a] = y * inverse[a];
      rest -= fits.y[a] * fits.y[a];
    }
    fits.mean_square[static_cast<std::size_t>(d)] = std::max(rest, 0.0) / m[0];
    fits.highest = d;
  }
  return fits;
}

std::array<float, 15> monomial_coefficients(const DegreeFits& fits, int degree) {
  std::array<float, 15> result{};
  std::array<double, 15> c{};
  const int p = kBasisSize[static_cast<std::size_t>(degree)];
  for (int i = p - 1; i >= 0; --i) {
    const auto a = static_cast<std::size_t>(i);
    double t = fits.y[a];
    for (std::size_t k = a + 1; k < static_cast<std::size_t>(p); ++k) t -= fits.l[k][a] * c[k];
    c[a] = t / fits.l[a][a];
    result[a] = static_cast<float>(c[a]);
  }
  return result;
}

}  // namespace sansmesh::inline v1
#endif
