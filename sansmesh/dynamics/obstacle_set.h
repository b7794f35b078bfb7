// Collision of vertices with obstacles.
#pragma once

#include <cstddef>

#include "sansmesh/simulate_options.h"

namespace sansmesh::inline v1 {

/// Signed distance of a point from an obstacle, negative inside, and the outward direction.
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

  /// Moves x out of all obstacles that contain it, sequentially. Removes from v the component into obstacles that
  /// contain x or are within `near`, and Coulomb's share of the tangential component. Removes from x the effect of that
  /// share over the time `moved` during which x has moved with v, so that a sticking point stays. Returns whether there
  /// was contact.
  bool push_out(Vec3& x, Vec3& v, double near, double moved) const;

  /// Whether an obstacle contains x deeper than `near`.
  bool holds(const Vec3& x, double near) const;

 private:
  std::vector<FloorObstacle> floors_;  ///< with unit normals
  std::vector<SphereObstacle> spheres_;
};

}  // namespace sansmesh::inline v1
