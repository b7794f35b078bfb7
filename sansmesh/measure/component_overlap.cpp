#include "sansmesh/measure/component_overlap.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/data/group_rows.h"
#include "sansmesh/mesh/repair/self_intersections.h"
#include "sansmesh/search/box_levels.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

/// Depth, relative to the diagonal, by which faces must cross each other's plane; rounding of float vertices is below
/// it.
constexpr double kCrossingDepth = 1e-6;
/// Probe points of a component for the winding number of the others. A face may coincide with another component's face,
/// and its solid is behind it: probes are behind their faces by this depth, relative to the diagonal of all, and at
/// most by this share of their component's diagonal.
constexpr std::size_t kProbes = 9;
constexpr double kProbeDepth = 4 * kCrossingDepth, kProbeShare = 1e-3;

/// Side of the point relative to the directed edge from a to b, seen along z; bit-identical for both directions.
double side_of_edge(const Vec3& a, const Vec3& b, const Vec3& p) {
  const bool turned = b.y < a.y || (b.y == a.y && b.x < a.x);
  const Vec3 &low = turned ? b : a, &high = turned ? a : b;
  const double side = (high.x - low.x) * (p.y - low.y) - (high.y - low.y) * (p.x - low.x);
  return turned ? -side : side;
}

/// Signed crossings of the ray from p along z out of the solid through the triangle: 1, 0, −1. A ray through an edge
/// meets one of its two triangles: an edge counts without its upper end, and only for points with a smaller x.
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

std::array<Vec3, 3> corners_of(const TriangleMesh& mesh, std::uint32_t i) {
  const auto [u, v, w] = mesh.triangles[i];
  return {Vec3(mesh.vertices[u]), Vec3(mesh.vertices[v]), Vec3(mesh.vertices[w])};
}

/// The triangles of closed components in a bounding-volume tree.
class SolidFaces {
 public:
  SolidFaces(const TriangleMesh& mesh, std::span<const std::uint32_t> component, std::span<const std::uint8_t> closed)
      : mesh_(mesh), component_(component) {
    std::vector<std::uint32_t> faces;
    std::vector<Vec3f> centers;
    for (std::uint32_t i = 0; i < component.size(); ++i) {
      if (!closed[component[i]]) continue;
      Vec3f center;
      for (const std::uint32_t v : mesh.triangles[i]) center += mesh.vertices[v] / 3.0f;
      faces.push_back(i), centers.push_back(center);
    }
    const KdTree order(centers);  // orders neighbours in space next to each other
    order_.reserve(faces.size());
    for (const std::uint32_t k : order.order()) order_.push_back(faces[k]);
    std::vector<Box3f> boxes(order_.size());
    parallel_for(0, boxes.size(), 8192, [&](std::size_t k) {
      for (const std::uint32_t v : mesh.triangles[order_[k]]) boxes[k].extend(mesh.vertices[v]);
    });
    levels_ = box_levels(std::move(boxes));
  }

  /// Winding number at p of all components but one.
  int winding(const Vec3& p, std::uint32_t but) const {
    return levels_.empty() ? 0 : winding(levels_.size() - 1, 0, p, but);
  }

 private:
  int winding(std::size_t level, std::size_t node, const Vec3& p, std::uint32_t but) const {
    const BoxNode& boxes = levels_[level][node];
    int sum = 0;
    for (std::size_t k = 0; k < kTreeWidth; ++k) {
      const auto within = [&](std::size_t axis) {
        return static_cast<double>(boxes.lower[axis][k]) <= p[axis] &&
               p[axis] <= static_cast<double>(boxes.upper[axis][k]);
      };
      if (!within(0) || !within(1) || !(p.z <= static_cast<double>(boxes.upper[2][k]))) continue;
      const std::size_t child = node * kTreeWidth + k;
      if (level > 0)
        sum += winding(level - 1, child, p, but);
      else if (component_[order_[child]] != but)
        sum += crossing_above(corners_of(mesh_, order_[child]), p);
    }
    return sum;
  }

  const TriangleMesh& mesh_;
  std::span<const std::uint32_t> component_;
  std::vector<std::uint32_t> order_;
  BoxLevels levels_;
};

/// Computes ComponentOverlap::surrounding. A single closed component has no others around it.
void find_surrounding(const TriangleMesh& mesh, std::span<const std::uint32_t> component,
                      std::span<const std::uint8_t> closed, std::vector<int>& surrounding) {
  if (std::count(closed.begin(), closed.end(), 1) < 2) return;
  const SolidFaces faces(mesh, component, closed);
  const Adjacency of_component = group_rows(surrounding.size(), [&](const auto& visit) {
    for (std::size_t i = 0; i < component.size(); ++i)
      if (closed[component[i]]) visit(component[i], i);
  });
  const double depth = kProbeDepth * bounds(mesh).diagonal();
  parallel_for(0, surrounding.size(), 1, [&](std::size_t c) {
    const std::span<const std::uint32_t> own = of_component[c];
    if (own.empty()) return;
    Box3f box;
    for (const std::uint32_t i : own)
      for (const std::uint32_t v : mesh.triangles[i]) box.extend(mesh.vertices[v]);
    const double inward = std::min(depth, kProbeShare * box.diagonal());
    std::vector<int> windings;
    const std::size_t probes = std::min(kProbes, own.size());
    for (std::size_t k = 0; k < probes; ++k) {
      const std::array<Vec3, 3> t = corners_of(mesh, own[k * own.size() / probes]);
      const Vec3 normal = normalized(cross(t[1] - t[0], t[2] - t[0]));
      windings.push_back(faces.winding((t[0] + t[1] + t[2]) / 3.0 - normal * inward, static_cast<std::uint32_t>(c)));
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
  std::vector<std::uint8_t> crosses(closed.size());
  const auto mark = [&](std::uint32_t c) {
    const std::atomic_ref flag(crosses[c]);
    if (flag.load(std::memory_order_relaxed) == 0) flag.store(1, std::memory_order_relaxed);
  };
  result.crossing_pairs =
      count_self_intersections(mesh, kCrossingDepth * bounds(mesh).diagonal(), [&](std::uint32_t a, std::uint32_t b) {
        if (component[a] != component[b]) mark(component[a]), mark(component[b]);
      });
  result.crossing_components = static_cast<std::size_t>(std::count(crosses.begin(), crosses.end(), 1));
  return result;
}

}  // namespace sansmesh::inline v1
