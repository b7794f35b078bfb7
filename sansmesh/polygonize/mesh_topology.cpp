#include "sansmesh/polygonize/mesh_topology.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"

namespace sansmesh {
namespace {

constexpr std::size_t kChunk = 8192;

bool has_area(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
  return squared_norm(cross(b - a, c - a)) > 0;  // false for NaN, too
}

/// The corners (3·triangle + k) at each vertex, in ascending order.
struct CornersOfVertex {
  std::vector<std::uint32_t> first, corner;

  CornersOfVertex(std::size_t vertices, const std::vector<Triangle>& triangles)
      : first(vertices + 1), corner(3 * triangles.size()) {
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t) ++first[v + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) corner[next[triangles[i][k]]++] = static_cast<std::uint32_t>(3 * i + k);
  }
};

/// A root for each vertex: vertices of one component have the same.
class Components {
 public:
  explicit Components(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// What is seen from one vertex; each edge is counted at its lower vertex.
struct Local {
  std::size_t vertices = 0, edges = 0, boundary = 0, nonmanifold_edges = 0, nonmanifold_vertices = 0, inconsistent = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> boundary_edges;
};

/// One triangle's part in the edge from a vertex to `other`.
struct Spoke {
  std::uint32_t other, triangle;
  bool outgoing;
  friend bool operator<(const Spoke& a, const Spoke& b) {
    return a.other != b.other ? a.other < b.other : a.triangle < b.triangle;
  }
};

void look_around(std::uint32_t v, const std::vector<Triangle>& triangles, const CornersOfVertex& corners,
                 std::vector<Spoke>& spokes, std::vector<std::uint32_t>& fan, Local& out) {
  const std::size_t first = corners.first[v], count = corners.first[v + 1] - first;
  if (count == 0) return;
  ++out.vertices;
  spokes.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t c = corners.corner[first + i], t = c / 3, k = c % 3;
    spokes.push_back({triangles[t][(k + 1) % 3], static_cast<std::uint32_t>(i), true});
    spokes.push_back({triangles[t][(k + 2) % 3], static_cast<std::uint32_t>(i), false});
  }
  std::sort(spokes.begin(), spokes.end());

  // Triangles that share an edge at v are in one fan.
  fan.resize(count);
  std::iota(fan.begin(), fan.end(), 0u);
  const auto root = [&](std::uint32_t i) {
    while (fan[i] != i) i = fan[i] = fan[fan[i]];
    return i;
  };
  std::size_t fans = count;
  for (std::size_t i = 0, j; i < spokes.size(); i = j) {
    std::size_t outgoing = 0;
    for (j = i; j < spokes.size() && spokes[j].other == spokes[i].other; ++j) {
      outgoing += spokes[j].outgoing;
      const std::uint32_t a = root(spokes[i].triangle), b = root(spokes[j].triangle);
      if (a != b) fan[b] = a, --fans;
    }
    const std::size_t shared = j - i;
    if (v > spokes[i].other) continue;
    ++out.edges;
    if (shared == 1) ++out.boundary, out.boundary_edges.emplace_back(v, spokes[i].other);
    if (shared == 2 && outgoing != 1) ++out.inconsistent;
    if (shared > 2) ++out.nonmanifold_edges;
  }
  if (fans > 1) ++out.nonmanifold_vertices;
}

std::size_t count_loops(std::size_t vertices, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& edges) {
  if (edges.empty()) return 0;
  Components loops(vertices);
  for (const auto& [a, b] : edges) loops.join(a, b);
  std::size_t count = 0;
  std::vector<std::uint8_t> seen(vertices);
  for (const auto& edge : edges) count += !std::exchange(seen[loops.find(edge.first)], std::uint8_t{1});
  return count;
}

}  // namespace

MeshTopology measure_topology(const TriangleMesh& mesh) {
  MeshTopology result;
  const std::size_t n = mesh.vertices.size();
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    const bool exists = t[0] < n && t[1] < n && t[2] < n;
    if (!exists || !has_area(mesh, t)) ++result.degenerate_triangles;
    if (exists && t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
  }
  result.triangles = triangles.size();

  const CornersOfVertex corners(n, triangles);
  const Local total = parallel_reduce(
      n, kChunk, Local{},
      [&](std::size_t first, std::size_t last) {
        Local part;
        std::vector<Spoke> spokes;
        std::vector<std::uint32_t> fan;
        for (std::size_t v = first; v < last; ++v)
          look_around(static_cast<std::uint32_t>(v), triangles, corners, spokes, fan, part);
        return part;
      },
      [](Local& sum, const Local& part) {
        sum.vertices += part.vertices;
        sum.edges += part.edges;
        sum.boundary += part.boundary;
        sum.nonmanifold_edges += part.nonmanifold_edges;
        sum.nonmanifold_vertices += part.nonmanifold_vertices;
        sum.inconsistent += part.inconsistent;
        sum.boundary_edges.insert(sum.boundary_edges.end(), part.boundary_edges.begin(), part.boundary_edges.end());
        return std::move(sum);
      });
  result.vertices = total.vertices;
  result.unused_vertices = n - total.vertices;
  result.edges = total.edges;
  result.boundary_edges = total.boundary;
  result.boundary_loops = count_loops(n, total.boundary_edges);
  result.nonmanifold_edges = total.nonmanifold_edges;
  result.nonmanifold_vertices = total.nonmanifold_vertices;
  result.inconsistent_edges = total.inconsistent;
  result.euler =
      static_cast<long>(result.vertices) - static_cast<long>(result.edges) + static_cast<long>(result.triangles);

  Components components(n);
  for (const Triangle& t : triangles) components.join(t[0], t[1]), components.join(t[1], t[2]);
  std::vector<std::size_t> size(n);
  for (const Triangle& t : triangles) result.components += size[components.find(t[0])]++ == 0;
  for (const std::size_t s : size) result.largest_component = std::max(result.largest_component, s);
  return result;
}

}  // namespace sansmesh
