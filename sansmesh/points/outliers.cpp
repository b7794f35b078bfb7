#include "sansmesh/points/outliers.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/points/local_frame.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh {
namespace {

constexpr std::size_t kNeighbours = 10;
/// Samples closer to each other than this many times the spacing around both belong together.
constexpr float kReach = 4;
/// Deviation across / along the best plane from where on the neighbours do not look like a surface; samples spread
/// evenly in space have about 0.6.
constexpr double kScattered = 0.4;
bool looks_scattered(const KdTree& tree, std::span<const std::uint32_t> neighbours) {
  std::vector<Vec3f> offsets;
  for (const std::uint32_t other : neighbours) offsets.push_back(tree.position(other) - tree.position(neighbours[0]));
  const Vec3 variance = principal_axes(moments(offsets).covariance).values;
  return variance.x > kScattered * kScattered * variance.y;
}

}  // namespace

void OutlierOptions::validate() const {
  if (!(isolation > 1)) throw ArgumentError("`isolation` is " + std::to_string(isolation) + "; it must exceed 1");
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
      const float reach = kReach * std::min(around[s], around[other]);
      if (squared_distance(tree.position(s), tree.position(other)) > reach * reach) continue;
      clusters.join(s, other);
    }
  }
  for (std::uint32_t s = 0; s < n; ++s) ++members[clusters.find(s)];
  for (std::uint32_t s = 0; s < n; ++s)
    if (isolated[s] || members[clusters.find(s)] < options.min_cluster) mask[tree.order()[s]] = 1;
  // A cloud of nothing but tiny clusters is sparse, not made of outliers.
  const auto marked = static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1));
  if (2 * marked > points.size())
    for (std::size_t i = 0; i < points.size(); ++i) mask[i] = is_finite(points.positions[i]) ? 0 : 1;
  progress.finish();
  return mask;
}

}  // namespace sansmesh
