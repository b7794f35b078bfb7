#include "sansmesh/volume/samples/star_metric.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/parallel.h"
#include "sansmesh/points/shape/principal_axes.h"

namespace sansmesh::inline v1 {
namespace {

// Extents below this fraction of the largest are rounding of the positions.
constexpr double kFlat = 1e-7;

StarMetric ball_metric(double radius) {
  const auto f = static_cast<float>(1 / radius);
  return {{Vec3f{f, 0, 0}, Vec3f{0, f, 0}, Vec3f{0, 0, f}}};
}

/// Radius for stars without extent.
double fallback_radius(const SampledVolume& volume) {
  const double r = std::max(volume.facts.median_spacing, 1e-6 * volume.bounds().diagonal());
  return r > 0 ? r : 1;
}

}  // namespace

StarMetric star_metric(std::span<const Vec3> offsets, double fallback, std::size_t nearest) {
  double longest = 0;
  for (const Vec3& d : offsets) longest = std::max(longest, norm(d));
  if (!(longest > 0)) return ball_metric(fallback);
  StarMetric metric;
  Symmetric3 moments;
  for (const Vec3& d : offsets) moments.add(d / longest, 1.0 / static_cast<double>(offsets.size()));
  const PrincipalAxes axes = principal_axes(moments);
  std::array<double, 3> extent;
  for (std::size_t k = 0; k < 3; ++k) extent[k] = std::sqrt(std::max(axes.values[k], 0.0));
  if (extent[1] < kFlat * extent[2]) extent[1] = extent[2];
  if (extent[0] < kFlat * extent[2]) extent[0] = std::min(extent[1], extent[2]);
  double farthest = 0;
  for (const Vec3& d : nearest > 0 ? offsets.first(nearest) : offsets) {
    double r2 = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double u = dot(d / longest, axes.axes[k]) / extent[k];
      r2 += u * u;
    }
    farthest = std::max(farthest, r2);
  }
  if (!(farthest > 0)) farthest = 1;
  const double scale = 1 / (longest * std::sqrt(farthest));
  for (std::size_t k = 0; k < 3; ++k) metric.rows[k] = Vec3f(axes.axes[k] * (scale / extent[k]));
  return metric;
}

std::vector<StarMetric> star_metrics(const SampledVolume& volume) {
  std::vector<StarMetric> metrics(volume.size());
  const double fallback = fallback_radius(volume);
  parallel_ranges(0, metrics.size(), 1024, [&](std::size_t first, std::size_t last) {
    std::vector<Vec3> offsets;
    for (std::size_t i = first; i < last; ++i) {
      offsets.clear();
      const auto star = volume.stars[i];
      for (const std::uint32_t j : star) offsets.push_back(volume.positions[j] - volume.positions[i]);
      if (star.size() < 6)
        for (const std::uint32_t j : star)
          for (const std::uint32_t k : volume.stars[j])
            if (k != i) offsets.push_back(volume.positions[k] - volume.positions[i]);
      metrics[i] = star_metric(offsets, fallback, star.size());
    }
  });
  return metrics;
}

std::vector<StarMetric> spherical_metrics(const SampledVolume& volume) {
  std::vector<StarMetric> metrics(volume.size());
  const double fallback = fallback_radius(volume);
  parallel_ranges(0, metrics.size(), 1024, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      double longest = 0;
      for (const std::uint32_t j : volume.stars[i])
        longest = std::max(longest, norm(volume.positions[j] - volume.positions[i]));
      metrics[i] = ball_metric(longest > 0 ? longest : fallback);
    }
  });
  return metrics;
}

double lattice_step(const std::vector<double>& axis, std::size_t i) {
  if (axis.size() == 1) return 1;  // single layers have no step
  return std::max(i > 0 ? axis[i] - axis[i - 1] : 0, i + 1 < axis.size() ? axis[i + 1] - axis[i] : 0);
}

StarMetric metric_of(const SampledVolume& volume, std::span<const StarMetric> metrics, std::size_t sample) {
  if (!volume.lattice) return metrics[sample];
  const Lattice& lattice = *volume.lattice;
  const auto at = lattice.indices(sample);
  StarMetric metric;
  for (std::size_t k = 0; k < 3; ++k)
    metric.rows[k] = Vec3f(lattice.directions[k] / lattice_step(lattice.axes[k], at[k]));
  return metric;
}

}  // namespace sansmesh::inline v1
