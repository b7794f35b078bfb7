#include "sansmesh/data/world_points.h"

#include <cstddef>

namespace sansmesh::inline v1 {

std::vector<Vec3> world_points(const Vec3& origin, std::span<const Vec3f> positions) {
  std::vector<Vec3> points(positions.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = origin + Vec3(positions[i]);
  return points;
}

void add_finite_points(const Vec3& origin, std::span<const Vec3f> positions, std::vector<Vec3>& points) {
  for (const Vec3f& p : positions)
    if (is_finite(p)) points.push_back(origin + Vec3(p));
}

Box3 finite_bounds(const Vec3& origin, std::span<const Vec3f> positions) {
  Box3 box;
  for (const Vec3f& p : positions)
    if (is_finite(p)) box.extend(origin + Vec3(p));
  return box;
}

}  // namespace sansmesh::inline v1
