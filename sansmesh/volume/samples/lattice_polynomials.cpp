#include "sansmesh/volume/samples/lattice_polynomials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/samples/stencil_fit.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kTaps = 5, kPowers = 5;  // samples along an axis; degrees 0..4

// Orthonormal polynomials on the taps around one coordinate of an axis.
struct AxisFit {
  std::size_t first = 0, taps = 0,
              powers = 0;  ///< powers: number of polynomials determined by the taps, at most kPowers
  double u[kTaps]{};       ///< local coordinates of the taps
  double weight[kTaps]{};
  double psi[kPowers][kTaps]{};         ///< values at the taps
  double row[kPowers][kTaps]{};         ///< times the weights
  double monomial[kPowers][kPowers]{};  ///< coefficients of ψ_a in powers of u
};

AxisFit axis_fit(const std::vector<double>& axis, std::size_t i, double width) {
  AxisFit fit;
  fit.taps = fit.powers = std::min(kTaps, axis.size());
  fit.first = std::min(i >= 2 ? i - 2 : 0, axis.size() - fit.taps);
  const double step = lattice_step(axis, i);
  for (std::size_t t = 0; t < fit.taps; ++t) {
    fit.u[t] = (axis[fit.first + t] - axis[i]) / step;
    fit.weight[t] = std::max(std::exp(-fit.u[t] * fit.u[t] / (width * width)), 1e-4);
  }
  // Gram–Schmidt twice: monomials on five points are not far from dependent.
  for (std::size_t a = 0; a < fit.powers; ++a) {
    double* p = fit.psi[a];
    double* c = fit.monomial[a];
    c[a] = 1;
    for (std::size_t t = 0; t < fit.taps; ++t) p[t] = std::pow(fit.u[t], static_cast<double>(a));
    for (int again = 0; again < 2; ++again)
      for (std::size_t b = 0; b < a; ++b) {
        double product = 0;
        for (std::size_t t = 0; t < fit.taps; ++t) product += fit.row[b][t] * p[t];
        for (std::size_t t = 0; t < fit.taps; ++t) p[t] -= product * fit.psi[b][t];
        for (std::size_t k = 0; k <= b; ++k) c[k] -= product * fit.monomial[b][k];
      }
    double norm2 = 0;
    for (std::size_t t = 0; t < fit.taps; ++t) norm2 += fit.weight[t] * p[t] * p[t];
    const double inverse = 1 / std::sqrt(norm2);
    for (std::size_t t = 0; t < fit.taps; ++t) p[t] *= inverse, fit.row[a][t] = fit.weight[t] * p[t];
    for (std::size_t k = 0; k <= a; ++k) c[k] *= inverse;
  }
  return fit;
}

// 1 / (1 − h)² of all samples of a stencil, for each degree.
struct Leverage {
  double factor[kPowers][kTaps * kTaps * kTaps];
};

Leverage leverage_of(const AxisFit& x, const AxisFit& y, const AxisFit& z) {
  Leverage l;
  std::size_t at = 0;
  for (std::size_t k = 0; k < z.taps; ++k)
    for (std::size_t j = 0; j < y.taps; ++j)
      for (std::size_t i = 0; i < x.taps; ++i, ++at) {
        double h = 0;
        for (std::size_t d = 0; d < kPowers; ++d) {
          for (std::size_t a = 0; a <= d; ++a)
            for (std::size_t b = 0; a + b <= d; ++b) {
              const std::size_t c = d - a - b;
              if (a >= x.powers || b >= y.powers || c >= z.powers) continue;
              h += x.psi[a][i] * x.row[a][i] * y.psi[b][j] * y.row[b][j] * z.psi[c][k] * z.row[c][k];
            }
          const double rest = 1 - std::min(h, 0.98);
          l.factor[d][at] = x.weight[i] * y.weight[j] * z.weight[k] / (rest * rest);
        }
      }
  return l;
}

class LatticeFitter {
 public:
  LatticeFitter(const SampledVolume& volume, const VolumeValues& values, const LocalPolynomialOptions& options)
      : lattice_(*volume.lattice), values_(values), options_(options), robust_(options.fit) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& axis = lattice_.axes[k];
      for (std::size_t i = 0; i < axis.size(); ++i) fits_[k].push_back(axis_fit(axis, i, options.fit.width));
      // Equal steps for the leverages: only the position of a sample in its taps matters.
      std::vector<double> even(axis.size());
      for (std::size_t i = 0; i < axis.size(); ++i) even[i] = static_cast<double>(i);
      const std::size_t taps = std::min(kTaps, axis.size());
      for (std::size_t own = 0; own < taps; ++own) {
        const std::size_t i = own <= 2 ? own : axis.size() - taps + own;
        even_[k].push_back(axis_fit(even, i, options.fit.width));
      }
    }
  }

  void append(std::size_t sample, PolynomialPart& part) {
    const auto at = lattice_.indices(sample);
    const AxisFit &x = fits_[0][at[0]], &y = fits_[1][at[1]], &z = fits_[2][at[2]];
    const std::size_t c = values_.components, n = x.taps * y.taps * z.taps;
    const std::size_t nx = lattice_.axes[0].size(), ny = lattice_.axes[1].size();
    f_.resize(n * c), r_.resize(n), orthogonal_.assign(c * kTerms, 0.0);
    double scores[kPowers] = {};
    const Leverage& leverage = leverage_at(at);
    for (std::size_t m = 0; m < c; ++m) {
      double* f = f_.data() + m * n;
      const double own = values_.values[sample * c + m];
      double largest = 0;
      for (std::size_t k = 0, to = 0; k < z.taps; ++k)
        for (std::size_t j = 0; j < y.taps; ++j) {
          const std::size_t row = (x.first + nx * (y.first + j + ny * (z.first + k))) * c + m;
          for (std::size_t i = 0; i < x.taps; ++i, ++to) {
            f[to] = values_.values[row + i * c] - own;
            largest = std::max(largest, std::abs(f[to]));
          }
        }
      if (largest == 0) continue;
      double* q = orthogonal_.data() + m * kTerms;
      project(f, x, y, z, q);
      std::copy(f, f + n, r_.begin());
      double zero = 0;
      for (int d = 0; d <= options_.fit.max_degree; ++d) {
        subtract(q, d, x, y, z);
        const double* factor = leverage.factor[d];
        double sum = 0;
        for (std::size_t i = 0; i < n; ++i) sum += factor[i] * r_[i] * r_[i];
        if (d == 0) zero = sum;
        scores[d] += zero > 0 ? sum / zero : 0;
      }
    }
    int degree = 0;
    double best = scores[0];
    for (int d = 1; d <= options_.fit.max_degree; ++d)
      if (scores[d] < 0.9 * best) degree = d, best = scores[d];
    if (options_.fit.robust && best > 0.01 * static_cast<double>(c) && scores[0] > 0 &&
        append_split(x, y, z, sample, part))
      return;
    const auto terms = static_cast<std::size_t>(monomial_count(3, degree));
    const int below = StencilFit::lower_degree(degree);
    const auto fewer = static_cast<std::size_t>(monomial_count(3, below));
    double monomials[kTerms];
    for (std::size_t m = 0; m < c; ++m) {
      to_monomials(orthogonal_.data() + m * kTerms, degree, x, y, z, monomials);
      part.append_component(std::span(monomials).first(terms), values_.of(sample)[m], options_.share);
      if (lattice_.uniform) continue;  // steps do not grow
      to_monomials(orthogonal_.data() + m * kTerms, below, x, y, z, monomials);
      part.append_lower(std::span(monomials).first(fewer));
    }
    part.degrees.push_back(static_cast<std::uint8_t>(degree));
    part.split.push_back(0);
  }

 private:
  static constexpr auto kTerms = static_cast<std::size_t>(monomial_count(3, 4));

  const Leverage& leverage_at(const std::array<std::size_t, 3>& at) {
    std::size_t own[3], slot = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      own[k] = at[k] - fits_[k][at[k]].first;
      slot = slot * kTaps + own[k];
    }
    auto& known = leverages_[slot];
    if (!known) known = std::make_unique<Leverage>(leverage_of(even_[0][own[0]], even_[1][own[1]], even_[2][own[2]]));
    return *known;
  }

  // Projections q on all products ψ_a ψ_b ψ_c, in the order of PolynomialOrder<3>, up to the highest degree.
  void project(const double* f, const AxisFit& x, const AxisFit& y, const AxisFit& z, double* q) const {
    const auto top = static_cast<std::size_t>(options_.fit.max_degree);
    double fx[kPowers][kTaps * kTaps], fy[kPowers][kPowers][kTaps];
    for (std::size_t a = 0; a <= top; ++a)
      for (std::size_t jk = 0; jk < y.taps * z.taps; ++jk) {
        double sum = 0;
        for (std::size_t i = 0; i < x.taps; ++i) sum += x.row[a][i] * f[jk * x.taps + i];
        fx[a][jk] = sum;
      }
    for (std::size_t a = 0; a <= top; ++a)
      for (std::size_t b = 0; a + b <= top; ++b)
        for (std::size_t k = 0; k < z.taps; ++k) {
          double sum = 0;
          for (std::size_t j = 0; j < y.taps; ++j) sum += y.row[b][j] * fx[a][k * y.taps + j];
          fy[a][b][k] = sum;
        }
    for (std::size_t d = 0, at = 0; d <= top; ++d)
      for (std::size_t a = d + 1; a-- > 0;)
        for (std::size_t b = d - a + 1; b-- > 0; ++at) {
          double sum = 0;
          for (std::size_t k = 0; k < z.taps; ++k) sum += z.row[d - a - b][k] * fy[a][b][k];
          q[at] = sum;
        }
  }

  // Subtracts the products of degree d from the residuals.
  void subtract(const double* q, int degree, const AxisFit& x, const AxisFit& y, const AxisFit& z) {
    const auto d = static_cast<std::size_t>(degree);
    std::size_t at = d == 0 ? 0 : static_cast<std::size_t>(monomial_count(3, degree - 1));
    double g[kPowers][kTaps * kTaps] = {};
    for (std::size_t a = d + 1; a-- > 0;)
      for (std::size_t b = d - a + 1; b-- > 0; ++at)
        for (std::size_t k = 0; k < z.taps; ++k) {
          const double s = q[at] * z.psi[d - a - b][k];
          for (std::size_t j = 0; j < y.taps; ++j) g[a][k * y.taps + j] += s * y.psi[b][j];
        }
    for (std::size_t jk = 0; jk < y.taps * z.taps; ++jk)
      for (std::size_t a = 0; a <= d; ++a)
        for (std::size_t i = 0; i < x.taps; ++i) r_[jk * x.taps + i] -= g[a][jk] * x.psi[a][i];
  }

  static void to_monomials(const double* q, int degree, const AxisFit& x, const AxisFit& y, const AxisFit& z,
                           double* monomials) {
    const auto d = static_cast<std::size_t>(degree);
    double all[kPowers][kPowers][kPowers] = {}, next[kPowers][kPowers][kPowers] = {};
    const auto each = [d](const auto& visit) {
      for (std::size_t e = 0, at = 0; e <= d; ++e)
        for (std::size_t a = e + 1; a-- > 0;)
          for (std::size_t b = e - a + 1; b-- > 0; ++at) visit(at, a, b, e - a - b);
    };
    each([&](std::size_t at, std::size_t a, std::size_t b, std::size_t c) {
      for (std::size_t p = 0; p <= c; ++p) all[a][b][p] += q[at] * z.monomial[c][p];
    });
    each([&](std::size_t, std::size_t a, std::size_t b, std::size_t c) {
      for (std::size_t p = 0; p <= b; ++p) next[a][p][c] += all[a][b][c] * y.monomial[b][p];
    });
    for (auto& plane : all)
      for (auto& row : plane) std::fill(std::begin(row), std::end(row), 0.0);
    each([&](std::size_t, std::size_t a, std::size_t b, std::size_t c) {
      for (std::size_t p = 0; p <= a; ++p) all[p][b][c] += next[a][b][c] * x.monomial[a][p];
    });
    each([&](std::size_t at, std::size_t a, std::size_t b, std::size_t c) { monomials[at] = all[a][b][c]; });
  }

  // Fits only the samples on this side of a step; false without a step.
  bool append_split(const AxisFit& x, const AxisFit& y, const AxisFit& z, std::size_t sample, PolynomialPart& part) {
    const std::size_t c = values_.components, n = x.taps * y.taps * z.taps;
    // The sample itself comes first.
    u_.clear();
    std::size_t own = 0;
    for (std::size_t k = 0; k < z.taps; ++k)
      for (std::size_t j = 0; j < y.taps; ++j)
        for (std::size_t i = 0; i < x.taps; ++i) {
          u_.push_back({x.u[i], y.u[j], z.u[k]});
          if (u_.back() == Vec3{}) own = u_.size() - 1;
        }
    std::swap(u_[0], u_[own]);
    for (std::size_t m = 0; m < c; ++m) std::swap(f_[m * n], f_[m * n + own]);
    if (!robust_.has_step(f_, n, c)) return false;
    tests_.clear();
    const auto at = lattice_.indices(sample);
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 u;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& axis = lattice_.axes[k];
        const bool up = (corner >> k & 1) != 0 ? at[k] + 1 < axis.size() : at[k] == 0;
        const double step = up ? axis[at[k] + 1] - axis[at[k]] : axis[at[k] - 1] - axis[at[k]];
        u[k] = 0.5 * step / lattice_step(axis, at[k]);
      }
      tests_.push_back(u);
    }
    robust_.fit(u_, f_, c, tests_);
    part.append(robust_, values_.of(sample), options_.share, !lattice_.uniform);
    return true;
  }

  const Lattice& lattice_;
  const VolumeValues& values_;
  LocalPolynomialOptions options_;
  StencilFit robust_;
  std::array<std::vector<AxisFit>, 3> fits_, even_;
  std::array<std::unique_ptr<Leverage>, kTaps * kTaps * kTaps> leverages_;
  std::vector<double> f_, r_, orthogonal_;
  std::vector<Vec3> u_, tests_;
};

}  // namespace

LocalPolynomials fit_lattice_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                         const LocalPolynomialOptions& options, Progress& progress) {
  LocalPolynomialOptions held = options;
  // Axes with few samples have few powers, which the products omit: a slab of two layers is linear across and of any
  // degree along. A degree above the powers of all axes does not exist.
  std::size_t most = 0;
  for (const auto& axis : volume.lattice->axes) most = std::max(most, std::min(axis.size(), kTaps));
  held.fit.max_degree = std::min(held.fit.max_degree, static_cast<int>(most) - 1);
  return gather_polynomials<PolynomialPart>(
      volume, values, progress, [&] { return LatticeFitter(volume, values, held); },
      [](LatticeFitter& fitter, std::size_t i, PolynomialPart& part) { fitter.append(i, part); }, {}, false);
}

}  // namespace sansmesh::inline v1
