#include "sansmesh/mesh/align/align_difference.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/align/align_fit.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Least number of offsets for a meaningful median.
constexpr std::size_t kFewestNeighbours = 5;
constexpr std::size_t kMostNeighbours = 64;
/// Significance threshold in standard deviations of a median; √n times the standard deviation of a median of n values
/// over that of the values.
constexpr double kSurelyNoChance = 4, kDeviationOfMedians = 1.2533;

}  // namespace

ShapeDifference shape_difference(const OrientedPoints& moving, const WholeSurface& fixed, const Similarity& pose,
                                 double spacing, double reach, double least, bool signs) {
  struct Offset {
    Vec3 offset, normal;
    bool counts = false;
  };
  std::vector<Offset> offsets(moving.size());
  parallel_for(0, moving.size(), 128, [&](std::size_t i) {
    Foot foot;
    const Vec3 at = pose(moving.x[i]);
    if (!fixed.closest(at, reach, foot) || foot.beyond) return;
    if (!alike_normals(pose.rotate(moving.n[i]), foot.normal, signs)) return;
    offsets[i] = {at - foot.point, foot.normal, squared_norm(foot.normal) > 0};
  });
  std::vector<Vec3f> points;
  std::vector<std::uint32_t> point_index;
  for (std::uint32_t i = 0; i < offsets.size(); ++i)
    if (offsets[i].counts) points.push_back(Vec3f(pose(moving.x[i]))), point_index.push_back(i);
  if (points.empty()) return {};

  const KdTree tree(points);
  struct Local {
    double middle = 0, scatter = 0;  ///< median of the heights, and median distance from it
    std::size_t count = 0;           ///< 0: undetermined
  };
  std::vector<Local> locals(points.size());
  parallel_for(0, points.size(), 64, [&](std::size_t p) {
    Neighbour near[kMostNeighbours];
    const std::size_t found = tree.nearest(points[p], near);
    std::vector<double> heights;
    const Vec3& normal = offsets[point_index[p]].normal;
    for (std::size_t k = 0; k < found && static_cast<double>(near[k].squared_distance) <= spacing * spacing; ++k)
      heights.push_back(dot(offsets[point_index[near[k].index]].offset, normal));
    if (heights.size() < kFewestNeighbours) return;
    Local& local = locals[p];
    local.count = heights.size();
    local.middle = median(heights);
    for (double& h : heights) h = std::abs(h - local.middle);
    local.scatter = median(heights);
  });
  // A few heights may coincide by chance: the noise is nowhere taken to be below its typical value.
  std::vector<double> scatters;
  for (const Local& local : locals)
    if (local.count > 0) scatters.push_back(local.scatter);
  if (scatters.empty()) return {};
  const double compared = static_cast<double>(scatters.size()), usual = median(scatters);
  std::vector<double> there;
  for (const Local& local : locals) {
    if (local.count == 0) continue;
    const double deviation = kDeviationOfMedians * kDeviationOverMedian * std::max(local.scatter, usual) /
                             std::sqrt(static_cast<double>(local.count));
    if (std::abs(local.middle) > std::max(least, kSurelyNoChance * deviation)) there.push_back(std::abs(local.middle));
  }
  const double share = static_cast<double>(there.size()) / compared;
  return {share, median(there)};
}

}  // namespace sansmesh::inline v1::detail
