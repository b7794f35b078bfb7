#include "sansmesh/mesh_measures.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/mesh/vertex_corners.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kTopologyChunk = 8192;

bool has_area(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
  return squared_norm(cross(b - a, c - a)) > 0;  // also false for NaN
}

/// Counts at one vertex; each edge is counted at its lower vertex.
struct Local {
  std::size_t vertices = 0, edges = 0, boundary = 0, nonmanifold_edges = 0, nonmanifold_vertices = 0, inconsistent = 0,
              open = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> boundary_edges;
};

/// Edge from a vertex to `other` in one triangle.
struct Spoke {
  std::uint32_t other, triangle;
  bool outgoing;
  friend bool operator<(const Spoke& a, const Spoke& b) {
    return a.other != b.other ? a.other < b.other : a.triangle < b.triangle;
  }
};

void look_around(std::uint32_t v, const std::vector<Triangle>& triangles, const VertexCorners& corners,
                 std::vector<Spoke>& spokes, std::vector<std::uint32_t>& fan, Local& out) {
  const std::size_t first = corners.first[v], count = corners.first[v + 1] - first;
  if (count == 0) return;
  ++out.vertices;
  spokes.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t c = corners.entries[first + i], t = c / 3, k = c % 3;
    spokes.push_back({triangles[t][(k + 1) % 3], static_cast<std::uint32_t>(i), true});
    spokes.push_back({triangles[t][(k + 2) % 3], static_cast<std::uint32_t>(i), false});
  }
  std::sort(spokes.begin(), spokes.end());

  // Joins triangles that share an edge at v.
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
    if (2 * outgoing != shared) ++out.open;
    if (shared > 2) ++out.nonmanifold_edges;
  }
  if (fans > 1) ++out.nonmanifold_vertices;
}

std::size_t count_loops(std::size_t vertices, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& edges) {
  if (edges.empty()) return 0;
  UnionFind loops(vertices);
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
    if (exists && has_distinct_corners(t)) triangles.push_back(t);
  }
  result.triangles = triangles.size();

  const VertexCorners corners(triangles, n);
  const Local total = parallel_reduce(
      n, kTopologyChunk, Local{},
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
        sum.open += part.open;
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
  result.open_edges = total.open;
  result.euler =
      static_cast<long>(result.vertices) - static_cast<long>(result.edges) + static_cast<long>(result.triangles);

  UnionFind components(n);
  for (const Triangle& t : triangles) components.join(t[0], t[1]), components.join(t[1], t[2]);
  std::vector<std::size_t> size(n);
  for (const Triangle& t : triangles) result.components += size[components.find(t[0])]++ == 0;
  for (const std::size_t s : size) result.largest_component = std::max(result.largest_component, s);
  return result;
}

namespace {

constexpr ReportRow kMeshTopologyRows[] = {
    reported<&MeshTopology::vertices>({.text = "Vertices that triangles use"}),
    reported<&MeshTopology::triangles>({.text = "Triangles with three different corners"}),
    reported<&MeshTopology::unused_vertices>({.text = "Vertices that no triangle uses"}),
    reported<&MeshTopology::degenerate_triangles>({.text = "Triangles without area or with coincident corners"}),
    reported<&MeshTopology::encloses>({.name = "closed", .text = "Whether the triangles enclose a volume"}),
    reported<&MeshTopology::manifold>({.text = "Whether the mesh is manifold"}),
    reported<[](const MeshTopology& r) {
      return value_if(r.edges > r.boundary_edges + r.nonmanifold_edges, r.oriented());
    }>({.name = "oriented",
        .text = "Whether neighbouring faces are consistently oriented; absent if no two share an edge"}),
    reported<&MeshTopology::boundary_edges>({.text = "Edges of one triangle"}),
    reported<&MeshTopology::boundary_loops>({.text = "Connected sets of boundary edges: holes"}),
    reported<&MeshTopology::open_edges>(
        {.text = "Edges that triangles traverse more often in one direction than in the other"}),
    reported<&MeshTopology::nonmanifold_edges>({.text = "Edges of three triangles or more"}),
    reported<&MeshTopology::nonmanifold_vertices>({.text = "Vertices whose triangles form several fans"}),
    reported<&MeshTopology::components>({.text = "Connected parts"}),
    reported<&MeshTopology::largest_component>({.text = "Triangles of the largest part"}),
    reported<&MeshTopology::euler>({.text = "Vertices − edges + triangles"}),
    reported<&MeshTopology::genus>({.text = "Total number of handles, if defined"})};

}  // namespace

const ReportSchema& MeshTopology::schema() {
  static constexpr ReportSchema schema{kMeshTopologyRows};
  return schema;
}

}  // namespace sansmesh::inline v1
