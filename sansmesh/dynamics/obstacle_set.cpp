#include "sansmesh/dynamics/obstacle_set.h"

namespace sansmesh::inline v1 {

ObstacleSet::ObstacleSet(const DynamicsScene& scene) : floors_(scene.floors), spheres_(scene.spheres) {
  for (FloorObstacle& f : floors_) f.normal = normalized(f.normal);
}

ObstacleSide ObstacleSet::side(std::size_t obstacle, const Vec3& x) const {
  if (obstacle < floors_.size()) {
    const FloorObstacle& f = floors_[obstacle];
    return {dot(f.normal, x - f.point), f.normal};
  }
  const SphereObstacle& s = spheres_[obstacle - floors_.size()];
  const Vec3 out = x - s.center;
  const double length = norm(out);
  return {length - s.radius, length > 0 ? out / length : Vec3{0, 0, 1}};
}

double ObstacleSet::friction(std::size_t obstacle) const {
  return obstacle < floors_.size() ? floors_[obstacle].friction : spheres_[obstacle - floors_.size()].friction;
}

bool ObstacleSet::holds(const Vec3& x, double near) const {
  for (std::size_t o = 0; o < size(); ++o) {
    if (side(o, x).distance < -near) return true;
  }
  return false;
}

bool ObstacleSet::push_out(Vec3& x, Vec3& v, double near, double moved) const {
  bool touched = false;
  for (std::size_t o = 0; o < size(); ++o) {
    const auto [distance, normal] = side(o, x);
    if (distance > near) continue;
    touched = true;
    if (distance < 0) x -= normal * distance;
    const double into = -dot(normal, v);
    if (into <= 0) continue;
    v += normal * into;
    const double along = norm(v), stopped = friction(o) * into;
    const double kept = along > stopped ? 1 - stopped / along : 0;
    x -= v * (moved * (1 - kept)), v *= kept;
  }
  return touched;
}

}  // namespace sansmesh::inline v1
