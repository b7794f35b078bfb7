#include "sansmesh/measure/points_signed_distance.h"

#include <cmath>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kRim = 9;  ///< the sample itself and its eight neighbours

}  // namespace

PointsDistance::PointsDistance(const TriangleMesh& points) : points_(points), tree_(points.vertices) {
  if (tree_.size() == 0) throw DataError("no points to measure distances to");
  Box3f box;
  for (const Vec3f& p : points.vertices)
    if (is_finite(p)) box.extend(p);
  bounds_ = {points.origin + Vec3(box.lower), points.origin + Vec3(box.upper)};
  if (points.normals.empty()) return;
  radius_.resize(points.vertices.size());
  tree_.for_each_nearest(kRim, [&](std::uint32_t slot, std::span<const Neighbour> near) {
    radius_[tree_.order()[slot]] = near.empty() ? 0.0f : std::sqrt(near.back().squared_distance);
  });
}

void PointsDistance::measure(std::span<const Vec3> x, double, std::span<MeasuredPoint> found) const {
  for (std::size_t i = 0; i < x.size(); ++i) {
    found[i] = {};
    const Vec3 query = x[i] - points_.origin;
    const auto nearest = tree_.nearest(Vec3f(query));
    if (!nearest) continue;
    const Vec3 sample(points_.vertices[nearest->index]), line = query - sample;
    const Vec3 normal = points_.normals.empty() ? Vec3{} : normalized(Vec3(points_.normals[nearest->index]));
    if (!(squared_norm(normal) > 0)) {
      found[i].distance = norm(line);
      found[i].point = points_.origin + sample;
      continue;
    }
    const double height = dot(line, normal);
    const Vec3 aside = line - normal * height;
    const double lateral = norm(aside), radius = static_cast<double>(radius_[nearest->index]);
    const double over = std::max(0.0, lateral - radius);
    found[i].distance = std::copysign(std::hypot(height, over), height);
    found[i].point = points_.origin + sample + (over > 0 ? aside * (radius / lateral) : aside);
  }
}

}  // namespace sansmesh::inline v1
