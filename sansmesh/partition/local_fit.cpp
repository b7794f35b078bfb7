#include "sansmesh/partition/local_fit.h"

#include <algorithm>
#include <cmath>

namespace sansmesh {
namespace {

// moment(a, b) = Σ weight u^a v^b, a + b <= 8, stored by total degree: index(a, b).
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

// The Gram matrix of the monomials holds few distinct numbers: the moments up to twice the degree.
template <int Degree>
void accumulate(const LocalSamples& s, std::array<double, kMoments>& moments, std::array<double, 15>& rhs, double& ww,
                double& weight_squares) {
  constexpr int kLanes = 8;
  constexpr int kM = (2 * Degree + 1) * (2 * Degree + 2) / 2;
  constexpr int kP = (Degree + 1) * (Degree + 2) / 2;
  double m[kM][kLanes] = {};
  double r[kP][kLanes] = {};
  double q[kLanes] = {}, w2[kLanes] = {};
  const std::size_t n = s.size();
  for (std::size_t i = 0; i < n; i += kLanes) {
    double u[kLanes], v[kLanes], h[kLanes], w[kLanes];
    for (int k = 0; k < kLanes; ++k) {
      const bool in = i + static_cast<std::size_t>(k) < n;
      const std::size_t j = in ? i + static_cast<std::size_t>(k) : i;
      u[k] = s.u[j], v[k] = s.v[j], h[k] = s.w[j], w[k] = in ? s.weight[j] : 0.0f;
    }
    double vp[2 * Degree + 1][kLanes];
    for (int k = 0; k < kLanes; ++k) vp[0][k] = 1;
    for (int b = 1; b <= 2 * Degree; ++b)
      for (int k = 0; k < kLanes; ++k) vp[b][k] = vp[b - 1][k] * v[k];
    double up[kLanes];
    for (int k = 0; k < kLanes; ++k) up[k] = w[k], q[k] += w[k] * h[k] * h[k], w2[k] += w[k] * w[k];
    for (int a = 0; a <= 2 * Degree; ++a) {
      for (int b = 0; a + b <= 2 * Degree; ++b) {
        const int at = moment_index(a, b);
        for (int k = 0; k < kLanes; ++k) m[at][k] += up[k] * vp[b][k];
        if (a + b <= Degree)
          for (int k = 0; k < kLanes; ++k) r[at][k] += up[k] * vp[b][k] * h[k];
      }
      for (int k = 0; k < kLanes; ++k) up[k] *= u[k];
    }
  }
  const auto total = [](const double* x) { return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7])); };
  for (int a = 0; a < kM; ++a) moments[static_cast<std::size_t>(a)] = total(m[a]);
  for (int a = 0; a < kP; ++a) rhs[static_cast<std::size_t>(a)] = total(r[a]);
  ww = total(q);
  weight_squares = total(w2);
}

}  // namespace

DegreeFits fit_all_degrees(const LocalSamples& samples, int max_degree) {
  DegreeFits fits;
  int degree = std::min(max_degree, kMaxDegree);
  while (degree > 0 && samples.size() < 2 * static_cast<std::size_t>(kBasisSize[static_cast<std::size_t>(degree)]))
    --degree;
  if (samples.size() == 0) return fits;
  std::array<double, kMoments> m{};
  std::array<double, 15> rhs{};
  double ww = 0, w2 = 0;
  switch (degree) {
    case 4:
      accumulate<4>(samples, m, rhs, ww, w2);
      break;
    case 3:
      accumulate<3>(samples, m, rhs, ww, w2);
      break;
    case 2:
      accumulate<2>(samples, m, rhs, ww, w2);
      break;
    case 1:
      accumulate<1>(samples, m, rhs, ww, w2);
      break;
    default:
      accumulate<0>(samples, m, rhs, ww, w2);
      break;
  }
  fits.weight_sum = m[0];
  if (!(m[0] > 0)) return fits;
  fits.effective_count = m[0] * m[0] / w2;

  // Cholesky of the Gram matrix = Gram–Schmidt on the monomials in their order: row a of L makes basis function a
  // orthonormal to those before it, so the fits of all degrees are prefixes of one another.
  double rest = ww;
  int basis = 0;
  for (int d = 0; d <= degree; ++d) {
    for (; basis < kBasisSize[static_cast<std::size_t>(d)]; ++basis) {
      const auto a = static_cast<std::size_t>(basis);
      for (std::size_t b = 0; b < a; ++b) {
        double t = m[static_cast<std::size_t>(
            moment_index(kExponents[a].u + kExponents[b].u, kExponents[a].v + kExponents[b].v))];
        for (std::size_t k = 0; k < b; ++k) t -= fits.l[a][k] * fits.l[b][k];
        fits.l[a][b] = t / fits.l[b][b];
      }
      const double own = m[static_cast<std::size_t>(moment_index(2 * kExponents[a].u, 2 * kExponents[a].v))];
      double t = own;
      for (std::size_t k = 0; k < a; ++k) t -= fits.l[a][k] * fits.l[a][k];
      if (!(t > 1e-9 * own) || !(own > 1e-12 * m[0])) return fits;
      fits.l[a][a] = std::sqrt(t);
      double y = rhs[a];
      for (std::size_t k = 0; k < a; ++k) y -= fits.l[a][k] * fits.y[k];
      fits.y[a] = y / fits.l[a][a];
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

}  // namespace sansmesh
