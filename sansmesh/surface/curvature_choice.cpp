#include "sansmesh/surface/curvature_choice.h"

#include <algorithm>
#include <cmath>
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
/// Growth of the error of quartics due to shape: the third power of the radius of neighbourhoods without symmetry.
constexpr double kQuarticOrder = 1.5;
/// Share of the changes of the curvatures that noise explains, where it is taken for noise.
constexpr double kMostlyNoise = 0.7;
/// Ratio of the sizes of a quartic and a quadric that resolve the same details. Where the noise is not known, below
/// this share of the residuals, details may be the noise: a larger quartic would remove them.
constexpr std::size_t kSameDetail = 3;
constexpr double kKnownNoise = 0.5;
/// Share of the squared error due to noise that is negligible.
constexpr double kLittleNoise = 0.1;
/// Fits of more unknowns are chosen if their expected squared error is below this share.
constexpr double kClearlyLess = 0.5;
/// Expected relative error of quartics on samples that are too coarse for them.
constexpr double kCoarseForQuartics = 0.1;

/// A fit of one tested sample.
struct TestedFit {
  std::array<double, 3> chi{};
  double variance = kNone;  ///< variance of the curvatures for heights of unit variance; kNone without a fit
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

/// The error of neighbourhoods of growing size, of the first `sizes`. `order`: the error due to shape grows with this
/// power of the size. Stops at a relative error of `enough`.
ExpectedErrors least_error(std::span<const TestedFits> fits, double noise, double order, double enough,
                           std::size_t sizes = kCount) {
  ExpectedErrors errors;
  double shape = 0;
  for (std::size_t s = 0; s < std::min(sizes, fits.size()); ++s) {
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

/// Noise of the heights about quartics: `noise` within the limits of their residuals, which hardly contain shape. A
/// residual that grows as shape does, with the fifth power of the radius, is shape.
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

/// Whether this noise causes most of the change of the curvatures between the smallest sizes.
bool is_noise(std::span<const TestedFits> fits, double noise) {
  const double variance = median_of(fits[0], &TestedFit::variance) - median_of(fits[1], &TestedFit::variance);
  return noise * noise * variance > kMostlyNoise * median_change(fits[0], fits[1]);
}

}  // namespace

bool find_nearest(const KdTree& tree, const PointSet& points, std::uint32_t sample, TestedNeighbourhoods& to) {
  const Vec3f x = points.positions[sample];
  to.normal = normalized(Vec3(points.normals[sample]));
  if (!(squared_norm(to.normal) > 0)) return false;
  std::vector<Neighbour> found(kCurvatureSizes.back());
  found.resize(tree.nearest(x, found));
  std::size_t seen = 0;
  for (std::size_t size = 0; size < kCurvatureSizes.size() && kCurvatureSizes[size] <= found.size(); ++size) {
    for (; seen < kCurvatureSizes[size]; ++seen) {
      const std::uint32_t i = found[seen].index;
      if (same_sheet(to.normal, points.normals[i])) to.offsets.emplace_back(points.positions[i] - x);
    }
    to.parts[size] = {to.offsets.size(), std::sqrt(static_cast<double>(found[seen - 1].squared_distance))};
  }
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
      fitter.start(near.normal);
      for (const Vec3& offset : near.along_edges) fitter.add(offset);
      for (std::size_t r = 0; r < 2; ++r) fit(near.rings[r], CurvatureSurface::directional, rings[r][p]);
    }
  });

  const double heights = noise_of_heights(quartics, noise), given = noise;
  // Where the noise is unknown, the residuals of coarse samples may be shape. More unknowns need more certainty than
  // larger neighbourhoods.
  if (!only_quadrics) noise = is_noise(quadrics, heights) ? heights : std::min(noise, heights);
  const ExpectedErrors quadric = least_error(quadrics, noise, 1, kGoodEnough);
  CurvatureChoice choice{kCurvatureSizes[quadric.best], CurvatureSurface::quadric};
  if (only_quadrics) return choice;
  std::size_t sizes = kCount;
  if (given < kKnownNoise * heights)
    while (sizes > quadric.best + 1 && kCurvatureSizes[sizes - 1] > kSameDetail * choice.neighbours) --sizes;
  const ExpectedErrors quartic = least_error(quartics, heights, kQuarticOrder, kGoodEnough / 20, sizes);
  const ExpectedErrors ring = least_error(rings, heights, 1, 0);
  // Without any change the heights are on planes: steps of a sensor, whose residuals reveal no noise.
  double least = quadric.least, share = kClearlyLess;
  if (quartic.least > 0 && quartic.least < share * least) {
    least = quartic.least;
    choice = {kCurvatureSizes[quartic.best], CurvatureSurface::quartic};
    choice.exact = heights * heights * median_of(quartics[quartic.best], &TestedFit::variance) < kLittleNoise * least;
    // On the rings of a mesh quartics are better than on the nearest vertices, unless the mesh is too coarse for them.
    const bool coarse = least > kCoarseForQuartics * kCoarseForQuartics * median_square(quartics[quartic.best]);
    share = coarse ? 1 : 0.1 * kClearlyLess;
  }
  if (ring.least > 0 && ring.least < share * least) choice = {0, CurvatureSurface::directional};
  return choice;
}

}  // namespace sansmesh::inline v1::detail
