#include "sansmesh/points/outliers.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/points/noise.h"
#include "sansmesh/points/normals.h"
#include "sansmesh/points/principal_axes.h"
#include "sansmesh/points/spacing.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kNeighbours = 10;
/// Samples closer to each other than this many times the spacing around both belong together.
constexpr float kReachOfStrays = 4;
/// Deviation across / along the best plane from where on the neighbours do not look like a surface; samples spread
/// evenly in space have about 0.6.
constexpr double kScattered = 0.4;
/// Detached clusters of no more than this share of the cloud are outliers if they look scattered.
constexpr double kSmallPart = 0.05;
/// Samples through which the surface is laid that a sample is measured from, at least.
constexpr int kFewestAround = 32;
/// A sample that is this many times farther from its neighbours than they are from theirs might be off the surface;
constexpr float kSparser = 1.3f;
/// with less noise than this (over the spacing) so might one whose neighbours do not look like a surface.
constexpr double kThickNoise = 0.35;
/// What is off the surface is so by this many times the spacing around it: less is a detail that the samples hardly
/// show.
constexpr float kOffByAtLeast = 1.5f;
/// Share of a sample's height from which on others count as beside it: a spike, a rib, another sheet.
constexpr double kBesidePlane = 0.6;
constexpr int kPlaneRounds = 3;
/// Where coordinates come in steps, what is nearer than so many of them is next to each other.
constexpr double kStepsBeside = 2;

bool looks_scattered(std::span<const Vec3f> offsets) {
  const Vec3 variance = principal_axes(moments(offsets).covariance).values;
  return variance.x > kScattered * kScattered * variance.y;
}

bool looks_scattered(const KdTree& tree, std::span<const std::uint32_t> neighbours) {
  std::vector<Vec3f> offsets;
  for (const std::uint32_t other : neighbours) offsets.push_back(tree.position(other) - tree.position(neighbours[0]));
  return looks_scattered(offsets);
}

/// Heights over a plane that those far from it do not draw.
struct RobustPlane {
  Vec3 normal, through;
  double deviation = 0;  ///< of the heights, by their median

  double height(const Vec3f& at) const { return dot(Vec3(at) - through, normal); }

  explicit RobustPlane(std::span<const Vec3f> places) {
    std::vector<double> weights(places.size(), 1), heights;
    for (int round = 0; round < kPlaneRounds; ++round) {
      double total = 0;
      through = {};
      for (std::size_t i = 0; i < places.size(); ++i) through += Vec3(places[i]) * weights[i], total += weights[i];
      if (!(total > 0)) return;
      through = through / total;
      Symmetric3 spread;
      for (std::size_t i = 0; i < places.size(); ++i) spread.add(Vec3(places[i]) - through, weights[i]);
      normal = smallest_axis(spread);
      heights.clear();
      for (const Vec3f& p : places) heights.push_back(std::abs(height(p)));
      std::vector<double> sorted = heights;
      deviation = 1.4826 * median(sorted);
      for (std::size_t i = 0; i < places.size(); ++i) {  // Geman & McClure
        const double t = heights[i] / (3 * deviation + 1e-30), w = 1 / (1 + t * t);
        weights[i] = w * w;
      }
    }
  }
};

}  // namespace

void OutlierOptions::validate() const {
  if (!(isolation > 1)) throw ArgumentError("`isolation` is " + std::to_string(isolation) + "; it must exceed 1");
  if (!(height > 1)) throw ArgumentError("`height` is " + std::to_string(height) + "; it must exceed 1");
}

std::vector<std::uint8_t> find_outliers(const PointSet& points, const OutlierOptions& options, Progress& progress) {
  options.validate();
  std::vector<std::uint8_t> mask(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_finite(points.positions[i])) mask[i] = 1;
  progress.begin("outliers", 2 * points.size());
  const KdTree tree(points.positions);
  const std::size_t n = tree.size();
  if (n < std::max<std::size_t>(options.min_cluster, kNeighbours + 2)) {
    progress.finish();
    return mask;
  }

  // Local spacing: mean distance to the neighbours that are not duplicates.
  constexpr std::size_t kFound = kNeighbours + 1;
  std::vector<std::uint32_t> neighbours(n * kFound);
  std::vector<float> spacing(n);
  tree.for_each_nearest(kFound, [&](std::uint32_t s, std::span<const Neighbour> found) {
    float sum = 0;
    int count = 0;
    for (std::size_t k = 0; k < kFound; ++k) {
      neighbours[s * kFound + k] = found[k].index;
      if (found[k].squared_distance > 0) sum += std::sqrt(found[k].squared_distance), ++count;
    }
    spacing[s] = count > 0 ? sum / static_cast<float>(count) : 0;
  });
  progress.advance(points.size());

  std::vector<float> sorted = spacing;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(n / 2), sorted.end());
  const float sparse = static_cast<float>(options.isolation) * sorted[n / 2];

  const NoiseEstimate measured = measure_noise(points);
  const auto beside_steps = static_cast<float>(kStepsBeside * measured.step);

  // Isolated: much farther from its neighbours than they are from theirs; or in a region that is sparse against the
  // whole cloud and no surface either, as in a thin cloud of stray samples, which have each other for neighbours.
  std::vector<std::uint8_t> isolated(n);
  std::vector<float> around(n);  // typical spacing of the neighbours
  parallel_ranges(0, n, 8192, [&](std::size_t first, std::size_t last) {
    std::vector<float> others;
    for (std::size_t s = first; s < last; ++s) {
      others.clear();
      for (std::size_t k = 0; k < kFound; ++k)
        if (neighbours[s * kFound + k] != s) others.push_back(spacing[neighbours[s * kFound + k]]);
      const auto middle = others.begin() + static_cast<std::ptrdiff_t>(others.size() / 2);
      std::nth_element(others.begin(), middle, others.end());
      around[s] = *middle;
      if (spacing[s] < beside_steps) continue;
      isolated[s] = *middle > 0 && spacing[s] > static_cast<float>(options.isolation) * *middle;
      if (!isolated[s] && spacing[s] > sparse)
        isolated[s] = looks_scattered(tree, std::span(neighbours).subspan(s * kFound, kFound));
    }
  });

  // Detached: clusters of too few samples, the isolated ones left out.
  UnionFind clusters(n);
  std::vector<std::uint32_t> members(n, 0);
  for (std::uint32_t s = 0; s < n; ++s) {
    if (isolated[s]) continue;
    for (std::size_t k = 0; k < kFound; ++k) {
      const std::uint32_t other = neighbours[s * kFound + k];
      if (isolated[other]) continue;
      const float reach = std::max(kReachOfStrays * std::min(around[s], around[other]), beside_steps);
      if (squared_distance(tree.position(s), tree.position(other)) > reach * reach) continue;
      clusters.join(s, other);
    }
  }
  for (std::uint32_t s = 0; s < n; ++s) ++members[clusters.find(s)];

  // Neighbourhoods that show the surface through the noise.
  const double noise = measured.deviation, typical = estimate_spacing(points);
  const bool thick = noise > kThickNoise * typical;
  const std::size_t wide = static_cast<std::size_t>(std::max(choose_neighbours(typical, noise), kFewestAround)) + 1;
  const auto small = static_cast<std::uint32_t>(kSmallPart * static_cast<double>(n));
  std::vector<std::uint32_t> cluster(n);
  for (std::uint32_t s = 0; s < n; ++s) cluster[s] = clusters.find(s);
  std::vector<std::uint8_t> scattered(n), off(n);
  parallel_ranges(0, n, 1024, [&](std::size_t first, std::size_t last) {
    std::vector<Neighbour> found(wide);
    std::vector<Vec3f> offsets;
    for (std::size_t s = first; s < last; ++s) {
      if (isolated[s]) continue;
      const std::span<const std::uint32_t> nearest = std::span(neighbours).subspan(s * kFound, kFound);
      const bool part = members[cluster[s]] <= small;
      const bool sparser = spacing[s] > kSparser * around[s] && around[s] > 0;
      const bool rough = !thick && !sparser && looks_scattered(tree, nearest);
      if (!part && !sparser && !rough) continue;
      const Vec3f place = tree.position(s);
      const std::size_t count = tree.nearest(place, found);
      offsets.clear();
      for (const Neighbour& other : std::span(found).first(count))
        if (other.squared_distance > 0) offsets.push_back(points.positions[other.index] - place);
      if (offsets.size() < kNeighbours) continue;
      // A rod is not flat to many neighbours, a noisy sheet not to few: neither is scattered.
      const bool shown = norm(offsets.back()) > 2 * beside_steps;
      if (part && shown) scattered[s] = looks_scattered(tree, nearest) && looks_scattered(offsets);
      if (!sparser && !rough) continue;
      const RobustPlane plane(offsets);
      const double height = plane.height({});
      if (std::abs(height) < options.height * plane.deviation) continue;
      if (std::abs(height) < static_cast<double>(std::max(kOffByAtLeast * around[s], beside_steps))) continue;
      const auto beside = std::count_if(offsets.begin(), offsets.end(), [&](const Vec3f& o) {
        return plane.height(o) * height > kBesidePlane * height * height &&
               static_cast<double>(norm(o)) < std::abs(height);
      });
      off[s] = static_cast<std::size_t>(beside) + 1 < options.min_cluster;
    }
  });
  std::vector<std::uint32_t> strays(n, 0);  // scattered samples of each cluster
  for (std::uint32_t s = 0; s < n; ++s) strays[cluster[s]] += scattered[s];
  const auto no_surface = [&](std::uint32_t c) {
    return members[c] < options.min_cluster || (members[c] <= small && 2 * strays[c] > members[c]);
  };
  for (std::uint32_t s = 0; s < n; ++s)
    if (isolated[s] || off[s] || no_surface(cluster[s])) mask[tree.order()[s]] = 1;
  // A cloud of nothing but tiny clusters is sparse, not made of outliers.
  const auto marked = static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1));
  if (2 * marked > points.size())
    for (std::size_t i = 0; i < points.size(); ++i) mask[i] = is_finite(points.positions[i]) ? 0 : 1;
  progress.finish();
  return mask;
}

}  // namespace sansmesh::inline v1
