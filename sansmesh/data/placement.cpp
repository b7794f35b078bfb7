#include "sansmesh/placement.h"

#include <cmath>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/point_set.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMoved = 1 << 15;

/// Skips additions of zero, so that negative zeros keep their sign.
void from_input(std::vector<Vec3f>& positions, const Vec3& origin, const Placement& place) {
  if (origin == place.origin) {
    parallel_for(0, positions.size(), kMoved,
                 [&](std::size_t i) { positions[i] = Vec3f(Vec3(positions[i]) * (1 / place.unit)); });
  } else {
    parallel_for(0, positions.size(), kMoved,
                 [&](std::size_t i) { positions[i] = Vec3f(place.from_input(origin, positions[i])); });
  }
}

void to_input(std::vector<Vec3f>& positions, double unit) {
  parallel_for(0, positions.size(), kMoved, [&](std::size_t i) { positions[i] = Vec3f(Vec3(positions[i]) * unit); });
}

Vec3 origin_in_input(const Vec3& origin, const Placement& place) {
  return origin == Vec3{} ? place.origin : place.to_input(origin);
}

}  // namespace

Placement placement_for(const Vec3& origin, double extent) {
  return {origin, extent > 0 ? std::exp2(std::ceil(std::log2(extent))) : 1};
}

void move_from_input(PointSet& points, const Placement& place) {
  from_input(points.positions, points.origin, place);
  from_input(points.scanners, points.origin, place);
  points.origin = {};
}

void move_from_input(TriangleMesh& mesh, const Placement& place) {
  from_input(mesh.vertices, mesh.origin, place);
  mesh.origin = {};
}

void move_to_input(PointSet& points, const Placement& place) {
  to_input(points.positions, place.unit);
  to_input(points.scanners, place.unit);
  points.origin = origin_in_input(points.origin, place);
}

void move_to_input(TriangleMesh& mesh, const Placement& place) {
  to_input(mesh.vertices, place.unit);
  mesh.origin = origin_in_input(mesh.origin, place);
}

}  // namespace sansmesh::inline v1
