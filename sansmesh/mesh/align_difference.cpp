#include "sansmesh/mesh/align_difference.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/align_fit.h"

namespace sansmesh::detail {
namespace {

/// Medians of so few offsets tell nothing.
constexpr std::size_t kFewestNeighbours = 5;
constexpr std::size_t kMostNeighbours = 64;
/// Standard deviations of a median beyond which it is no chance; and deviation over median of the absolute offsets.
constexpr double kSurelyNoChance = 4, kDeviationOfMedianOffset = 1.4826, kDeviationOfMedians = 1.2533;

}  // namespace

ShapeDifference shape_difference(const OrientedPoints& moving, const WholeSurface& fixed, const Pose& pose,
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
    if (!alike_normals(pose.turn(moving.n[i]), foot.normal, signs)) return;
    offsets[i] = {at - foot.point, foot.normal, squared_norm(foot.normal) > 0};
  });
  std::vector<Vec3f> places;
  std::vector<std::uint32_t> of_place;
  for (std::uint32_t i = 0; i < offsets.size(); ++i)
    if (offsets[i].counts) places.push_back(Vec3f(pose(moving.x[i]))), of_place.push_back(i);
  if (places.empty()) return {};

  const KdTree tree(places);
  std::vector<double> differing(places.size());  // below 0: not told
  parallel_for(0, places.size(), 64, [&](std::size_t p) {
    differing[p] = -1;
    Neighbour near[kMostNeighbours];
    const std::size_t found = tree.nearest(places[p], near);
    std::vector<double> heights;
    const Vec3& normal = offsets[of_place[p]].normal;
    for (std::size_t k = 0; k < found && static_cast<double>(near[k].squared_distance) <= spacing * spacing; ++k)
      heights.push_back(dot(offsets[of_place[near[k].index]].offset, normal));
    if (heights.size() < kFewestNeighbours) return;
    const double middle = median(heights);
    std::vector<double> scatter;
    for (const double h : heights) scatter.push_back(std::abs(h - middle));
    const double deviation = kDeviationOfMedians * kDeviationOfMedianOffset * median(scatter) /
                             std::sqrt(static_cast<double>(heights.size()));
    differing[p] = std::abs(middle) > std::max(least, kSurelyNoChance * deviation) ? std::abs(middle) : 0;
  });
  std::size_t told = 0;
  std::vector<double> there;
  for (const double d : differing) {
    told += d >= 0;
    if (d > 0) there.push_back(d);
  }
  if (told == 0) return {};
  return {static_cast<double>(there.size()) / static_cast<double>(told), median(there)};
}

}  // namespace sansmesh::detail
