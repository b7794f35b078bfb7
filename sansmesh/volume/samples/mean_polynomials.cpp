#include "sansmesh/volume/samples/mean_polynomials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/volume/samples/cell_quadrature.h"
#include "sansmesh/volume/samples/mean_fit.h"
#include "sansmesh/volume/samples/sample_stencil.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kMeanRings = 6;
constexpr double kEnoughMeans = 2, kPlentyMeans = 4;  // cells of a stencil, in multiples of the number of polynomials
constexpr double kLeastMeanWeight = 1e-4;
/// Fits of logarithms, each of which knows the difference between the mean of the logarithm and the logarithm of the
/// mean better.
constexpr int kLogarithmFits = 2;
/// Largest such difference: wild polynomials of the first fits.
constexpr double kMostDifference = 1;

using Means = MeanFit::Means;

Means means_of(std::span<const QuadraturePoint> points, const StarMetric& metric, int degree) {
  Means mean{};
  for (const QuadraturePoint& p : points) {
    const Means at = monomials_at(metric(p.x), degree);
    for (std::size_t k = 0; k < at.size(); ++k) mean[k] += p.weight * at[k];
  }
  return mean;
}

class MeanFitter {
 public:
  MeanFitter(const SampledVolume& volume, const CellQuadrature& cells, const VolumeValues& values,
             const LocalPolynomialOptions& options)
      : volume_(volume),
        cells_(cells),
        values_(values),
        options_(options),
        stencil_(volume),
        fit_(options.fit.max_degree),
        steps_(options.fit) {}

  void append(std::uint32_t i, const StarMetric& metric, PolynomialPart& part) {
    const int degree = options_.fit.max_degree;
    const auto basis = static_cast<double>(monomial_count(3, degree));
    stencil_.gather(i, metric, static_cast<std::size_t>(kEnoughMeans * basis),
                    static_cast<std::size_t>(kPlentyMeans * basis), kMeanRings);
    const auto samples = stencil_.samples();
    const auto local = stencil_.local();
    const std::size_t n = samples.size(), c = values_.components;
    f_.resize(n * c), means_.resize(n), weights_.resize(n);
    for (std::size_t m = 0; m < c; ++m)
      for (std::size_t s = 0; s < n; ++s)
        f_[m * n + s] = values_.values[samples[s] * c + m] - values_.values[i * c + m];
    const Vec3 origin = volume_.positions[i];
    const double width = options_.fit.width * options_.fit.width;
    for (std::size_t s = 0; s < n; ++s) {
      points_of(samples[s], origin);
      means_[s] = means_of(points_, metric, degree);
      weights_[s] = std::max(std::exp(-squared_norm(local[s]) / width), kLeastMeanWeight);
    }
    const bool split = options_.fit.robust && steps_.has_step(f_, n, c);
    std::size_t own = 0;
    for (std::size_t s = 0; split && s < n; ++s) own += steps_.own_side(s) ? 1 : 0;
    const bool one_sided = split && own >= 4;
    for (std::size_t s = 1; one_sided && s < n; ++s)
      if (!steps_.own_side(s)) weights_[s] = 0;
    tests_.clear();
    for (const std::uint32_t cell : cells_.cells_of(i))
      for (const std::uint32_t k : volume_.cells[cell])
        tests_.push_back(monomials_at(metric(volume_.corner(k) - origin), degree));
    fit_.fit(means_, weights_, f_, c, tests_);
    const auto terms = static_cast<std::size_t>(monomial_count(3, fit_.degree()));
    for (std::size_t m = 0; m < c; ++m) {
      const auto monomials = fit_.monomials(m);
      part.constants.push_back(values_.values[i * c + m] + monomials[0]);
      for (std::size_t k = 1; k < terms; ++k) part.coefficients.push_back(static_cast<float>(monomials[k]));
    }
    part.degrees.push_back(static_cast<std::uint8_t>(fit_.degree()));
    part.split.push_back(one_sided ? 1 : 0);
  }

 private:
  void points_of(std::uint32_t sample, const Vec3& origin) {
    if (options_.fit.max_degree > 3)
      cells_.fine_points(sample, origin, points_);
    else
      cells_.points(sample, origin, points_);
  }

  const SampledVolume& volume_;
  const CellQuadrature& cells_;
  const VolumeValues& values_;
  LocalPolynomialOptions options_;
  SampleStencil stencil_;
  MeanFit fit_;
  StencilFit steps_;
  std::vector<double> f_, weights_;
  std::vector<Means> means_, tests_;
  std::vector<QuadraturePoint> points_;
};

/// Constants with which the means of the polynomials with trust are the values.
std::vector<double> exact_constants(const SampledVolume& volume, const CellQuadrature& cells,
                                    const VolumeValues& values, const LocalPolynomials& p) {
  const std::size_t c = values.components;
  std::vector<double> constants(p.constants.begin(), p.constants.end());
  parallel_ranges(0, volume.size(), 512, [&](std::size_t begin, std::size_t end) {
    std::vector<QuadraturePoint> points;
    for (std::size_t i = begin; i < end; ++i) {
      const int degree = p.degrees[i];
      if (degree == 0) continue;
      const auto sample = static_cast<std::uint32_t>(i);
      degree > 3 ? cells.fine_points(sample, volume.positions[i], points)
                 : cells.points(sample, volume.positions[i], points);
      const Means mean = means_of(points, p.metric(volume, i), degree);
      for (std::size_t m = 0; m < c; ++m) {
        const auto terms = p.of(i, m);
        double rise = 0;
        for (std::size_t k = 0; k < terms.size(); ++k)
          rise += static_cast<double>(terms[k]) * mean[k + 1] * (k < 3 ? 1.0 : static_cast<double>(p.trust[i]));
        constants[i * c + m] = values.values[i * c + m] - rise;
      }
    }
  });
  return constants;
}

/// log(mean of exp(p)) − mean of the values: by how much the constants are too large.
std::vector<double> excess_of_exponentials(const SampledVolume& volume, const CellQuadrature& cells,
                                           const VolumeValues& values, const LocalPolynomials& p) {
  std::vector<double> excess(volume.size(), 0.0);
  parallel_ranges(0, volume.size(), 512, [&](std::size_t begin, std::size_t end) {
    std::vector<QuadraturePoint> points;
    for (std::size_t i = begin; i < end; ++i) {
      cells.fine_points(static_cast<std::uint32_t>(i), volume.positions[i], points);
      const StarMetric metric = p.metric(volume, i);
      const double base = p.constants[i] - values.values[i];
      double sum = 0;
      for (const QuadraturePoint& q : points) sum += q.weight * std::exp(base + p.rise(i, 0, metric(q.x)));
      const double found = std::log(sum);
      if (std::isfinite(found)) excess[i] = found;
    }
  });
  return excess;
}

}  // namespace

LocalPolynomials fit_mean_polynomials(const SampledVolume& volume, const VolumeValues& values,
                                      const LocalPolynomialOptions& options, bool logarithm, Progress& progress) {
  const CellQuadrature cells(volume);
  const std::vector<StarMetric> metrics = star_metrics(volume);
  const auto fitted = [&](const VolumeValues& of) {
    LocalPolynomials p = gather_polynomials<PolynomialPart>(
        volume, of, progress, [&] { return MeanFitter(volume, cells, of, options); },
        [&](MeanFitter& fitter, std::size_t i, PolynomialPart& part) {
          fitter.append(static_cast<std::uint32_t>(i), metrics[i], part);
        },
        metrics, options.ask_in_cells);
    p.constants = exact_constants(volume, cells, of, p);
    return p;
  };
  LocalPolynomials p = fitted(values);
  if (!logarithm) return p;
  VolumeValues inner = values;
  for (int fit = 1; fit < kLogarithmFits; ++fit) {
    const std::vector<double> excess = excess_of_exponentials(volume, cells, inner, p);
    // The excess is over the means of the logarithm: what the values exceed those by.
    for (std::size_t i = 0; i < excess.size(); ++i)
      inner.values[i] = values.values[i] - std::clamp(excess[i], 0.0, kMostDifference);
    p = fitted(inner);
  }
  const std::vector<double> excess = excess_of_exponentials(volume, cells, values, p);
  std::vector<double> constants(p.constants.begin(), p.constants.end());
  for (std::size_t i = 0; i < excess.size(); ++i) constants[i] -= excess[i];
  p.constants = std::move(constants);
  return p;
}

}  // namespace sansmesh::inline v1
