// Obstacles as vertices meet them.
#pragma once

#include <cstddef>
#include <span>

#include "sansmesh/simulate_options.h"

namespace sansmesh::inline v1 {

/// What an obstacle is to a point: its signed distance, negative within, and the direction out of it.
struct ObstacleSide {
  double distance = 0;
  Vec3 normal;
};

/// The floors and spheres of a scene, numbered in this order.
class ObstacleSet {
 public:
  explicit ObstacleSet(const DynamicsScene& scene);

  std::size_t size() const { return floors_.size() + spheres_.size(); }
  bool empty() const { return size() == 0; }
  ObstacleSide side(std::size_t obstacle, const Vec3& x) const;
  double friction(std::size_t obstacle) const;

  /// Moves x out of all obstacles that it is in, as far as one after the other can, and takes from v what leads into
  /// those that it is in or within `near` of, and Coulomb's share of what leads along them; from x, too, what that
  /// share made of the way in the time `moved` for which x has gone with v: where it sticks it stays. Whether there was
  /// an obstacle.
  bool push_out(Vec3& x, Vec3& v, double near, double moved) const;

  /// Whether x lies in an obstacle, deeper than `near`.
  bool holds(const Vec3& x, double near) const;

 private:
  std::vector<FloorObstacle> floors_;  ///< unit normals
  std::vector<SphereObstacle> spheres_;
};

}  // namespace sansmesh::inline v1
