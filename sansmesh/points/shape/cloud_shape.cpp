#include "sansmesh/points/shape/cloud_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/points/shape/principal_axes.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kShapeChunk = 65536;

/// Least gap between parts, relative to the length of the cloud.
constexpr double kEmptyShare = 0.3;

struct CloudSpan {
  CloudShape shape = CloudShape::empty;
  Vec3 center;
  double diagonal = 0;  ///< diagonal of the box
  Vec3 longest;         ///< principal axis; zero for a single point
};

CloudSpan span_of(const PointSet& points) {
  // Offsets from the centre of the box in double avoid cancellation far from the origin.
  Box3f box;
  std::size_t finite = 0;
  for (const Vec3f& p : points.positions)
    if (is_finite(p)) box.extend(p), ++finite;
  if (finite == 0) return {};
  const Vec3 center = Box3{Vec3(box.lower), Vec3(box.upper)}.center();
  const double diagonal = norm(Vec3(box.upper) - Vec3(box.lower));
  double largest_coordinate = 0;
  for (std::size_t k = 0; k < 3; ++k)
    largest_coordinate = std::max(
        {largest_coordinate, std::abs(static_cast<double>(box.lower[k])), std::abs(static_cast<double>(box.upper[k]))});
  const double rounding = 4 * static_cast<double>(std::numeric_limits<float>::epsilon()) * largest_coordinate;
  if (diagonal <= rounding) return {CloudShape::point, center, diagonal, {}};

  const std::vector<Vec3f>& positions = points.positions;
  const auto add = [](Symmetric3 a, const Symmetric3& b) {
    return Symmetric3{a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
  };
  const auto offset = [&](std::size_t i) { return (Vec3(positions[i]) - center) / diagonal; };
  const Vec3 mean = parallel_reduce(
                        positions.size(), kShapeChunk, Vec3{},
                        [&](std::size_t first, std::size_t last) {
                          Vec3 sum;
                          for (std::size_t i = first; i < last; ++i)
                            if (is_finite(positions[i])) sum += offset(i);
                          return sum;
                        },
                        [](Vec3 a, const Vec3& b) { return a + b; }) /
                    static_cast<double>(finite);
  const Symmetric3 covariance = parallel_reduce(
      positions.size(), kShapeChunk, Symmetric3{},
      [&](std::size_t first, std::size_t last) {
        Symmetric3 sum;
        for (std::size_t i = first; i < last; ++i)
          if (is_finite(positions[i])) sum.add(offset(i) - mean);
        return sum;
      },
      add);
  const PrincipalAxes axes = principal_axes(covariance);
  Box3 extent;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!is_finite(positions[i])) continue;
    const Vec3 o = offset(i);
    extent.extend({dot(o, axes.axes[0]), dot(o, axes.axes[1]), dot(o, axes.axes[2])});
  }
  const Vec3 size = extent.size();
  const double tolerance = 1e-6 * std::max({size.x, size.y, size.z}) + rounding / diagonal;
  const CloudShape shape = size.y <= tolerance   ? CloudShape::line
                           : size.x <= tolerance ? CloudShape::plane
                                                 : CloudShape::volume;
  return {shape, center, diagonal, axes.axes[2]};
}

}  // namespace

CloudShape classify_shape(const PointSet& points) { return span_of(points).shape; }

std::optional<FarParts> find_far_parts(const PointSet& points) {
  const CloudSpan whole = span_of(points);
  if (whole.shape != CloudShape::line && whole.shape != CloudShape::plane) return std::nullopt;
  std::vector<std::pair<double, Vec3f>> along;
  for (const Vec3f& p : points.positions)
    if (is_finite(p)) along.emplace_back(dot(Vec3(p) - whole.center, whole.longest), p);
  std::sort(along.begin(), along.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::size_t cut = 1;
  const auto gap = [&](std::size_t i) { return along[i].first - along[i - 1].first; };
  for (std::size_t i = 2; i < along.size(); ++i)
    if (gap(i) > gap(cut)) cut = i;
  if (gap(cut) < kEmptyShare * (along.back().first - along.front().first)) return std::nullopt;
  PointSet parts[2];
  for (std::size_t i = 0; i < along.size(); ++i) parts[i < cut ? 0 : 1].positions.push_back(along[i].second);
  const CloudSpan a = span_of(parts[0]), b = span_of(parts[1]);
  const bool points_alone = a.shape == CloudShape::point && b.shape == CloudShape::point;
  if (points_alone ? !(std::max(a.diagonal, b.diagonal) > 0) : std::max(a.shape, b.shape) <= whole.shape)
    return std::nullopt;
  return FarParts{gap(cut), std::max(a.diagonal, b.diagonal)};
}

}  // namespace sansmesh::inline v1
