#include "sansmesh/local_frame.h"

#include <cmath>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/point_set.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMoved = 1 << 15;

/// Skips additions of zero, so that negative zeros keep their sign.
void from_input(std::vector<Vec3f>& positions, const Vec3& origin, const LocalFrame& frame) {
  if (origin == frame.origin) {
    parallel_for(0, positions.size(), kMoved,
                 [&](std::size_t i) { positions[i] = Vec3f(Vec3(positions[i]) * (1 / frame.unit)); });
  } else {
    parallel_for(0, positions.size(), kMoved,
                 [&](std::size_t i) { positions[i] = Vec3f(frame.from_input(origin, positions[i])); });
  }
}

void to_input(std::vector<Vec3f>& positions, double unit) {
  parallel_for(0, positions.size(), kMoved, [&](std::size_t i) { positions[i] = Vec3f(Vec3(positions[i]) * unit); });
}

Vec3 origin_in_input(const Vec3& origin, const LocalFrame& frame) {
  return origin == Vec3{} ? frame.origin : frame.to_input(origin);
}

}  // namespace

LocalFrame frame_for(const Vec3& origin, double extent) {
  return {origin, extent > 0 ? std::exp2(std::ceil(std::log2(extent))) : 1};
}

void move_from_input(PointSet& points, const LocalFrame& frame) {
  from_input(points.positions, points.origin, frame);
  from_input(points.scanners, points.origin, frame);
  points.origin = {};
}

void move_from_input(TriangleMesh& mesh, const LocalFrame& frame) {
  from_input(mesh.vertices, mesh.origin, frame);
  mesh.origin = {};
}

void move_to_input(PointSet& points, const LocalFrame& frame) {
  to_input(points.positions, frame.unit);
  to_input(points.scanners, frame.unit);
  points.origin = origin_in_input(points.origin, frame);
  if (frame.reference) points.reference = frame.reference;
}

void move_to_input(TriangleMesh& mesh, const LocalFrame& frame) {
  to_input(mesh.vertices, frame.unit);
  mesh.origin = origin_in_input(mesh.origin, frame);
  if (frame.reference) mesh.reference = frame.reference;
}

}  // namespace sansmesh::inline v1
