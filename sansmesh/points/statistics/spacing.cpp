#include "sansmesh/points/statistics/spacing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sansmesh/core/median.h"
#include "sansmesh/points/shape/principal_axes.h"
#include "sansmesh/points/statistics/neighbourhood_sample.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kSpacingNeighbourhoods = 500;
constexpr std::size_t kNear = 24;    ///< neighbours for the spacing of a clean cloud
constexpr std::size_t kWide = 200;   ///< neighbours if noise hides the surface from the nearest ones
constexpr double kThickness = 0.35;  ///< ratio of deviations across and along the surface above which noise hides it

// Edge of one sample's square if `count` samples share a disc.
double spacing_of_disc(double radius, double count) { return radius * std::sqrt(std::numbers::pi / count); }

// Projects the neighbourhood onto its plane and counts within a radius in which its thickness is complete.
double flattened_spacing(const Neighbourhood& neighbourhood) {
  const Moments m = moments(neighbourhood.offsets);
  const Vec3 normal = principal_axes(m.covariance).axes[0];
  const double radius = 0.6 * static_cast<double>(neighbourhood.distances.back());
  double count = 0;
  for (const Vec3f& o : neighbourhood.offsets) {
    const Vec3 d(o);
    const double height = dot(d, normal);
    if (squared_norm(d) - height * height <= radius * radius) ++count;
  }
  return spacing_of_disc(radius, count);
}

}  // namespace

double estimate_spacing(const PointSet& points) {
  const std::vector<Neighbourhood> sample = sample_neighbourhoods(points.positions, kSpacingNeighbourhoods, kWide);
  std::vector<double> spacing, thickness, flattened;
  for (const Neighbourhood& neighbourhood : sample) {
    const std::size_t k = std::min(kNear, neighbourhood.offsets.size() - 1);
    if (k == 0) continue;
    spacing.push_back(spacing_of_disc(neighbourhood.distances[k], static_cast<double>(k)));
    const Vec3 variance = principal_axes(moments(std::span(neighbourhood.offsets).first(k + 1)).covariance).values;
    thickness.push_back(variance.y > 0 ? std::sqrt(std::max(variance.x, 0.0) / variance.y) : 0);
    if (neighbourhood.offsets.size() * 2 > kWide) flattened.push_back(flattened_spacing(neighbourhood));
  }
  const bool thick = median(thickness) > kThickness && flattened.size() * 2 > spacing.size();
  return thick ? median(flattened) : median(spacing);
}

double local_spacing(double squared_distance, double mean) {
  return std::clamp(spacing_of_disc(std::sqrt(squared_distance), static_cast<double>(kLocalNeighbours)),
                    kLeastLocal * mean, kMostLocal * mean);
}

}  // namespace sansmesh::inline v1
