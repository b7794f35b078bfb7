#include "sansmesh/surface/curvature_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <span>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr std::size_t kCount = kCurvatureSizes.size();
constexpr double kGoodEnough = 0.02;  ///< relative error of the curvatures that needs no larger neighbourhood
constexpr double kNone = -1;
/// Ratio of sizes whose curvatures are compared.
constexpr double kLarger = 1.2;
/// Fits of more unknowns are chosen if their expected squared error is below this share.
constexpr double kClearlyLess = 0.5;

/// A fit of one tested sample.
struct TestedFit {
  std::array<double, 3> chi{};
  double variance = kNone;  ///< of the curvatures for heights of unit variance; kNone without a fit
  double residual = kNone;  ///< variance of the heights about the fitted surface
  double size = 0;          ///< number of neighbours
};
/// Fits of all tested samples with one surface and size.
using TestedFits = std::vector<TestedFit>;

double median_of(const TestedFits& fits, double TestedFit::*value) {
  std::vector<double> values;
  for (const TestedFit& f : fits)
    if (f.variance >= 0 && f.*value >= 0) values.push_back(f.*value);
  return values.empty() ? kNone : median(values);
}

double median_square(const TestedFits& fits) {
  std::vector<double> values;
  for (const TestedFit& f : fits)
    if (f.variance >= 0) values.push_back(f.chi[0] * f.chi[0] + f.chi[1] * f.chi[1] + f.chi[2] * f.chi[2]);
  return values.empty() ? 0 : median(values);
}

/// Median of the squared change of the curvatures between two sets of fits.
double median_change(const TestedFits& a, const TestedFits& b) {
  std::vector<double> values;
  for (std::size_t p = 0; p < a.size(); ++p) {
    if (a[p].variance < 0 || b[p].variance < 0) continue;
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += (a[p].chi[c] - b[p].chi[c]) * (a[p].chi[c] - b[p].chi[c]);
    values.push_back(sum);
  }
  return values.empty() ? kNone : median(values);
}

/// Median of a sum of squared normal deviates over its mean (Wilson and Hilferty).
double median_over_mean(double count) { return std::pow(std::max(0.3, 1 - 2 / (9 * count)), 3); }

/// Expected squared errors of the curvatures, by size.
struct ExpectedErrors {
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
};

/// The error of neighbourhoods of growing size. `order`: the error due to shape grows with this power of the size.
/// Stops at a relative error of `enough`.
ExpectedErrors least_error(std::span<const TestedFits> fits, double noise, double order, double enough) {
  ExpectedErrors errors;
  double shape = 0;
  for (std::size_t s = 0; s < fits.size(); ++s) {
    const double size = median_of(fits[s], &TestedFit::size);
    if (size < 0) continue;
    // Neighbourhoods of whole rings may be the same for two sizes.
    std::size_t larger = s + 1;
    while (larger < fits.size() && median_of(fits[larger], &TestedFit::size) < kLarger * size) ++larger;
    if (larger == fits.size()) break;
    const double variance = noise * noise * median_of(fits[s], &TestedFit::variance);
    const double next = noise * noise * median_of(fits[larger], &TestedFit::variance);
    const double growth = std::pow(median_of(fits[larger], &TestedFit::size) / size, order) - 1;
    // The change is `growth` times the error due to shape, plus the effect of the noise, whose variance decreases by
    // the difference of the two (the larger fit is the better one); 0.7 of it in the median.
    const double change = median_change(fits[s], fits[larger]);
    if (change < 0) continue;
    shape = std::max(shape, std::max(0.0, change - 0.7 * (variance - next)) / (growth * growth));
    if (variance + shape < errors.least) errors = {variance + shape, s};
    if (errors.least < enough * enough * (median_square(fits[s]) - variance)) break;
  }
  return errors;
}

/// Noise of the heights, at most `noise` or what quartics leave over. Their residuals hardly contain shape: if they
/// grow with its power of the radius, the fifth, they are shape.
double noise_of_heights(std::span<const TestedFits> quartics, double noise) {
  for (std::size_t s = 0; s + 1 < quartics.size(); ++s) {
    const double here = median_of(quartics[s], &TestedFit::residual), size = median_of(quartics[s], &TestedFit::size);
    if (here < 0) continue;
    std::size_t larger = s + 1;
    while (larger < quartics.size() && median_of(quartics[larger], &TestedFit::size) < kLarger * size) ++larger;
    if (larger == quartics.size()) break;
    const double next = median_of(quartics[larger], &TestedFit::residual);
    const double growth = std::pow(median_of(quartics[larger], &TestedFit::size) / size, 5);
    const double least = std::sqrt(std::max(0.0, (growth * here - next) / (growth - 1)));
    return std::clamp(noise, least, std::max(least, std::sqrt(here)));
  }
  return noise;
}

}  // namespace

bool find_nearest(const KdTree& tree, const PointSet& points, std::uint32_t sample, TestedNeighbourhoods& to) {
  const Vec3f x = points.positions[sample];
  to.normal = normalized(Vec3(points.normals[sample]));
  if (!(squared_norm(to.normal) > 0)) return false;
  std::vector<Neighbour> found(kCurvatureSizes.back());
  found.resize(tree.nearest(x, found));
  std::size_t seen = 0;
  const auto add_to = [&](std::size_t count) {
    for (; seen < count; ++seen) {
      const std::uint32_t i = found[seen].index;
      if (same_sheet(to.normal, points.normals[i])) to.offsets.emplace_back(points.positions[i] - x);
    }
    return TestedNeighbourhoods::Part{to.offsets.size(),
                                      std::sqrt(static_cast<double>(found[count - 1].squared_distance))};
  };
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t count = (kDirectionalNeighbours - 1) * (k + 1) + 1;
    if (count <= found.size()) to.rings[k] = add_to(count);
  }
  for (std::size_t size = 0; size < kCurvatureSizes.size() && kCurvatureSizes[size] <= found.size(); ++size)
    to.parts[size] = add_to(kCurvatureSizes[size]);
  return true;
}

bool only_quadrics(const CurvatureOptions& options) {
  return options.weights != CurvatureOptions::Weights::m_like || options.tau != 2 || !options.offset ||
         !options.refit_normal;
}

CurvatureChoice choose_curvature(std::size_t tested, const std::function<FindNeighbourhoods()>& make_finder,
                                 double noise, bool only_quadrics) {
  std::array<TestedFits, kCount> quadrics, quartics;
  std::array<TestedFits, 2> rings;
  for (auto* const all : {&quadrics, &quartics})
    for (TestedFits& fits : *all) fits.resize(tested);
  for (TestedFits& fits : rings) fits.resize(tested);
  parallel_ranges(0, tested, 100, [&](std::size_t first, std::size_t last) {
    const CurvatureOptions options;
    CurvatureFitter fitter(options);
    TestedNeighbourhoods near;
    const FindNeighbourhoods find = make_finder();
    const auto fit = [&](const TestedNeighbourhoods::Part& part, CurvatureSurface surface, TestedFit& made) {
      if (part.count == 0 || !fitter.fit(part.count, part.radius, surface)) return;
      const double spare = static_cast<double>(part.count) - static_cast<double>(kQuarticUnknowns);
      const double residual = spare >= 1 ? fitter.residual_variance(part.count) / median_over_mean(spare) : kNone;
      made = {fitter.chi(), fitter.variance(part.count), residual, static_cast<double>(part.count)};
    };
    for (std::size_t p = first; p < last; ++p) {
      near = {};
      if (!find(p, near)) continue;
      fitter.start(near.normal);
      for (const Vec3& offset : near.offsets) fitter.add(offset);
      for (std::size_t s = 0; s < kCount; ++s) {
        fit(near.parts[s], CurvatureSurface::quadric, quadrics[s][p]);
        fit(near.parts[s], CurvatureSurface::quartic, quartics[s][p]);
      }
      if (!near.along_edges.empty()) {
        fitter.start(near.normal);
        for (const Vec3& offset : near.along_edges) fitter.add(offset);
      }
      for (std::size_t r = 0; r < 2; ++r) fit(near.rings[r], CurvatureSurface::directional, rings[r][p]);
    }
  });

  if (std::getenv("CURV")) {
    const auto show = [&](const char* name, const TestedFits& f, const TestedFits* next) {
      std::fprintf(stderr, "%-9s n %5.0f  res %.3g  var %.3g  size %.3g  change %.3g\n", name,
                   median_of(f, &TestedFit::size), std::sqrt(std::max(0.0, median_of(f, &TestedFit::residual))),
                   std::sqrt(std::max(0.0, median_of(f, &TestedFit::variance))), std::sqrt(median_square(f)),
                   next ? std::sqrt(std::max(0.0, median_change(f, *next))) : 0.0);
    };
    std::fprintf(stderr, "noise %.3g\n", noise);
    show("ring", rings[0], &rings[1]), show("ring", rings[1], nullptr);
    for (std::size_t s = 0; s < kCount; ++s) show("quadric", quadrics[s], s + 1 < kCount ? &quadrics[s + 1] : nullptr);
    for (std::size_t s = 0; s < kCount; ++s) show("quartic", quartics[s], s + 1 < kCount ? &quartics[s + 1] : nullptr);
  }

  noise = noise_of_heights(quartics, noise);
  const ExpectedErrors quadric = least_error(quadrics, noise, 1, kGoodEnough);
  const ExpectedErrors quartic = least_error(quartics, noise, 1.5, kGoodEnough / 20);
  const ExpectedErrors ring = least_error(rings, noise, 1, 0);
  CurvatureChoice choice{kCurvatureSizes[quadric.best], CurvatureSurface::quadric};
  if (only_quadrics) return choice;
  double least = kClearlyLess * quadric.least;
  if (quartic.least < least) least = quartic.least, choice = {kCurvatureSizes[quartic.best], CurvatureSurface::quartic};
  if (ring.least < least) choice = {0, CurvatureSurface::directional};
  if (std::getenv("CURV"))
    std::fprintf(stderr, "noise %.3g: quadric %.3g at %zu, quartic %.3g at %zu, ring %.3g\n", noise,
                 std::sqrt(quadric.least), kCurvatureSizes[quadric.best], std::sqrt(quartic.least),
                 kCurvatureSizes[quartic.best], std::sqrt(ring.least));
  return choice;
}

}  // namespace sansmesh::inline v1::detail
