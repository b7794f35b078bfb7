#include "sansmesh/measure/component_overlap.h"

#include <algorithm>
#include <array>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/self_intersections.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh {
namespace {

/// Part of the diagonal that faces have to reach beyond each other's plane: rounding of float vertices stays below it.
constexpr double kCrossingDepth = 1e-6;
/// Points of a component at which the others are asked for. Some of them may lie on another component's face.
constexpr std::size_t kProbes = 9;

/// Which side of the directed edge from a to b the point is on, seen along z; the same to the bit for both directions.
double side_of_edge(const Vec3& a, const Vec3& b, const Vec3& p) {
  const bool turned = b.y < a.y || (b.y == a.y && b.x < a.x);
  const Vec3 &low = turned ? b : a, &high = turned ? a : b;
  const double side = (high.x - low.x) * (p.y - low.y) - (high.y - low.y) * (p.x - low.x);
  return turned ? -side : side;
}

/// How often the ray from p along z runs out of the solid through the triangle: 1, 0, −1. A ray through an edge meets
/// one of its two triangles: an edge counts without its upper end, and for points with a smaller x only.
int crossing_above(const std::array<Vec3, 3>& t, const Vec3& p) {
  int winding = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = t[k], &b = t[(k + 1) % 3];
    if ((a.y <= p.y) == (b.y <= p.y)) continue;
    const double side = side_of_edge(a, b, p);
    const bool up = a.y <= p.y;
    if (up ? side > 0 : side < 0) winding += up ? 1 : -1;
  }
  if (winding == 0) return 0;
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  if (normal.z == 0) return 0;
  const double height = t[0].z - p.z + (normal.x * (t[0].x - p.x) + normal.y * (t[0].y - p.y)) / normal.z;
  return height > 0 ? winding : 0;
}

std::vector<Vec3f> centroids_of(const TriangleMesh& mesh, std::vector<float>& radii) {
  std::vector<Vec3f> centers(mesh.triangles.size());
  radii.resize(centers.size());
  parallel_for(0, centers.size(), 8192, [&](std::size_t i) {
    Vec3f c;
    for (const std::uint32_t v : mesh.triangles[i]) c += mesh.vertices[v] / 3.0f;
    float radius = 0;
    for (const std::uint32_t v : mesh.triangles[i]) radius = std::max(radius, norm(mesh.vertices[v] - c));
    centers[i] = c;
    radii[i] = radius * 1.0001f;
  });
  return centers;
}

/// Fills in ComponentOverlap::surrounding. A single closed component has no others around it.
void find_surrounding(const TriangleMesh& mesh, std::span<const std::uint32_t> component,
                      std::span<const std::uint8_t> closed, std::vector<int>& surrounding) {
  if (std::count(closed.begin(), closed.end(), 1) < 2) return;
  std::vector<float> radii;
  const std::vector<Vec3f> centers = centroids_of(mesh, radii);
  const KdTree order(centers);
  std::vector<Vec3f> sorted_centers;
  std::vector<float> sorted_radii;
  for (const std::uint32_t i : order.order()) sorted_centers.push_back(centers[i]), sorted_radii.push_back(radii[i]);
  const BallTree tree(sorted_centers, sorted_radii);

  std::vector<std::vector<std::uint32_t>> of_component(surrounding.size());
  for (std::uint32_t i = 0; i < component.size(); ++i)
    if (closed[component[i]]) of_component[component[i]].push_back(i);
  const float top = bounds(mesh).upper.z;
  parallel_for(0, surrounding.size(), 1, [&](std::size_t c) {
    const std::vector<std::uint32_t>& own = of_component[c];
    if (own.empty()) return;
    std::vector<int> windings;
    std::vector<std::uint32_t> near;
    const std::size_t probes = std::min(kProbes, own.size());
    for (std::size_t k = 0; k < probes; ++k) {
      const Vec3f at = centers[own[k * own.size() / probes]];
      tree.touching({at, {at.x, at.y, std::max(at.z, top)}}, near);
      int winding = 0;
      for (const std::uint32_t slot : near) {
        const std::uint32_t i = order.order()[slot];
        if (component[i] == c || !closed[component[i]]) continue;
        const auto [u, v, w] = mesh.triangles[i];
        winding += crossing_above({Vec3(mesh.vertices[u]), Vec3(mesh.vertices[v]), Vec3(mesh.vertices[w])}, Vec3(at));
      }
      windings.push_back(winding);
    }
    surrounding[c] = median(windings);
  });
}

}  // namespace

ComponentOverlap component_overlap(const TriangleMesh& mesh, std::span<const std::uint32_t> component,
                                   std::span<const std::uint8_t> closed) {
  ComponentOverlap result;
  result.surrounding.resize(closed.size());
  find_surrounding(mesh, component, closed, result.surrounding);
  const auto crossing = self_intersections(mesh, kCrossingDepth * bounds(mesh).diagonal());
  result.crossing_pairs = crossing.size();
  std::vector<std::uint8_t> crosses(closed.size());
  for (const auto& [a, b] : crossing)
    if (component[a] != component[b]) crosses[component[a]] = crosses[component[b]] = 1;
  result.crossing_components = static_cast<std::size_t>(std::count(crosses.begin(), crosses.end(), 1));
  return result;
}

}  // namespace sansmesh
