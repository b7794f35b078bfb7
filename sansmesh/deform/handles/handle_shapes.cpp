#include "sansmesh/deform/handles/handle_shapes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/mesh/edit/arrows.h"
#include "sansmesh/mesh/edit/tubes.h"
#include "sansmesh/mesh/mesh_vertices.h"
#include "sansmesh/polyline_set.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kBallLevels = 2;          // subdivisions of an octahedron: 128 triangles
constexpr double kThin = 0.35;          // radius of rods and arrows, in radii of the balls
constexpr double kDirectionLength = 5;  // in radii

/// The unit ball.
TriangleMesh unit_ball() {
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < kBallLevels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto next = static_cast<std::uint32_t>(mesh.vertices.size());
      const auto [at, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)}, next);
      if (fresh) mesh.vertices.push_back(normalized(mesh.vertices[a] + mesh.vertices[b]));
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  mesh.normals = mesh.vertices;
  return mesh;
}

/// Merges meshes, each with its colour, relative to one origin.
class Shapes {
 public:
  explicit Shapes(const Vec3& origin) { all_.origin = origin; }

  void add(const TriangleMesh& mesh, const std::array<std::uint8_t, 3>& color, double scale = 1, Vec3 at = {}) {
    const auto first = static_cast<std::uint32_t>(all_.vertices.size());
    for (const Vec3f& v : mesh.vertices)
      all_.vertices.push_back(Vec3f((mesh.origin + Vec3(v)) * scale + at - all_.origin));
    all_.normals.insert(all_.normals.end(), mesh.normals.begin(), mesh.normals.end());
    all_.colors.resize(all_.vertices.size(), color);
    for (const Triangle& t : mesh.triangles) all_.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  TriangleMesh take() { return std::move(all_); }

 private:
  TriangleMesh all_;
};

}  // namespace

TriangleMesh handle_shapes(std::span<const Handle> handles, const HandleShapeOptions& options) {
  const double r = options.radius;
  if (!(r > 0) || !std::isfinite(r))
    throw ArgumentError("`radius` of handles must be positive, not " + std::to_string(r));
  const TriangleMesh ball = unit_ball();
  Shapes shapes(handles.empty() ? Vec3{} : handles[0].p);
  std::vector<Vec3> from, way, axis_at, axis;
  for (const Handle& h : handles) {
    for (const bool after : {false, true}) {
      const auto& color = after ? options.after : options.before;
      const Vec3& begin = after ? h.q : h.p;
      shapes.add(ball, color, r, begin);
      if (!h.p_end) continue;
      const Vec3& end = after ? *h.q_end : *h.p_end;
      shapes.add(ball, color, r, end);
      PolylineSet rod;
      rod.origin = begin;
      rod.positions = {Vec3f{}, Vec3f(end - begin)};
      rod.offsets = {0, 2};
      TubeOptions tube;
      tube.radius = kThin * r;
      shapes.add(tubes(rod, tube), color);
    }
    if (norm(h.q - h.p) > 2 * r) from.push_back(h.p), way.push_back(h.q - h.p);
    if (h.p_end && norm(*h.q_end - *h.p_end) > 2 * r) from.push_back(*h.p_end), way.push_back(*h.q_end - *h.p_end);
    for (const TurnedDirection& d : h.directions)
      axis_at.push_back(h.q), axis.push_back(d.after * (kDirectionLength * r));
  }
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double length = norm(way[i]), thin = kThin * r / length;
    ArrowOptions arrow;
    arrow.shaft_radius = 0.6 * thin, arrow.head_radius = 1.6 * thin;
    arrow.head_length = std::min(0.5, 5 * thin);
    shapes.add(arrows(std::span(from).subspan(i, 1), std::span(way).subspan(i, 1), arrow), options.after);
  }
  if (!axis.empty()) shapes.add(arrows(axis_at, axis), options.after);
  return shapes.take();
}

TriangleMesh fold_shapes(const FoldReport& folds, const std::array<std::uint8_t, 3>& color) {
  TriangleMesh mesh;
  const GridBlock& block = folds.determinants;
  const auto* const determinants = block.point_arrays.find<float>("determinant");
  if (folds.folds.empty() || !determinants) return mesh;
  const std::array<std::size_t, 3> n{block.axes[0].size(), block.axes[1].size(), block.axes[2].size()};
  const std::array<std::size_t, 3> stride{1, n[0], n[0] * n[1]};
  mesh.origin = block.origin;
  // Faces of the cell around a point; corners at half a step.
  for (std::size_t p = 0; p < determinants->size(); ++p) {
    if (!((*determinants)[p] <= 0)) continue;
    const std::array<std::size_t, 3> i{p % n[0], p / n[0] % n[1], p / n[0] / n[1]};
    Vec3 center, half;
    for (std::size_t k = 0; k < 3; ++k) {
      center[k] = block.axes[k][i[k]];
      half[k] = 0.5 * (block.axes[k].back() - block.axes[k].front()) / static_cast<double>(n[k] - 1);
    }
    for (std::size_t k = 0; k < 3; ++k)
      for (const int side : {-1, 1}) {
        const bool last = side < 0 ? i[k] == 0 : i[k] + 1 == n[k];
        if (!last && (*determinants)[side < 0 ? p - stride[k] : p + stride[k]] <= 0) continue;
        const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        Vec3f normal;
        normal[k] = static_cast<float>(side);
        for (int c = 0; c < 4; ++c) {
          Vec3 corner = center;
          corner[k] += side * half[k];
          corner[a] += (c == 1 || c == 2 ? half[a] : -half[a]) * side;
          corner[b] += c >= 2 ? half[b] : -half[b];
          mesh.vertices.push_back(Vec3f(corner));
          mesh.normals.push_back(normal);
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
      }
  }
  mesh.colors.assign(mesh.vertices.size(), color);
  return mesh;
}

}  // namespace sansmesh::inline v1
