#include "sansmesh/mesh/components.h"

#include <algorithm>
#include <numeric>

#include "sansmesh/core/union_find.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh/mesh_vertices.h"
#include "sansmesh/mesh/vertex_corners.h"

namespace sansmesh {
MeshComponents find_components(const TriangleMesh& mesh) {
  UnionFind sets(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) sets.join(t[0], t[1]), sets.join(t[0], t[2]);
  MeshComponents result;
  result.of_triangle.resize(mesh.triangles.size());
  std::vector<std::uint32_t> number(mesh.vertices.size(), kNoVertex);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    std::uint32_t& c = number[sets.find(t[0])];
    if (c == kNoVertex) {
      c = static_cast<std::uint32_t>(result.area.size());
      result.area.push_back(0);
    }
    result.of_triangle[i] = c;
    result.area[c] += triangle_area(Vec3(mesh.vertices[t[0]]), Vec3(mesh.vertices[t[1]]), Vec3(mesh.vertices[t[2]]));
  }
  std::vector<std::uint32_t> order(result.area.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return result.area[a] > result.area[b]; });
  std::vector<std::uint32_t> rank(order.size());
  std::vector<double> area(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    rank[order[k]] = static_cast<std::uint32_t>(k), area[k] = result.area[order[k]];
  result.area = std::move(area);
  for (std::uint32_t& c : result.of_triangle) c = rank[c];
  return result;
}

void keep_triangles(TriangleMesh& mesh, const std::vector<std::uint8_t>& keep) {
  std::vector<std::uint32_t> renumber(mesh.vertices.size(), kNoVertex), kept, used;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!keep[i]) continue;
    for (const std::uint32_t v : mesh.triangles[i]) renumber[v] = 0;
    mesh.triangles[kept.size()] = mesh.triangles[i];
    kept.push_back(static_cast<std::uint32_t>(i));
  }
  if (kept.size() < mesh.triangles.size() && !mesh.triangle_attributes.empty())
    mesh.triangle_attributes = mesh.triangle_attributes.taken(kept);
  mesh.triangles.resize(kept.size());
  for (std::size_t v = 0; v < renumber.size(); ++v) {
    if (renumber[v] == kNoVertex) continue;
    renumber[v] = static_cast<std::uint32_t>(used.size());
    used.push_back(static_cast<std::uint32_t>(v));
  }
  if (used.size() < renumber.size()) take_vertices(mesh, used);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = renumber[v];
}

void separate_fans(TriangleMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  const VertexCorners corners(mesh.triangles, n);
  const std::vector<std::uint32_t>&first = corners.first, &corner = corners.corner;
  // All fans are found on the mesh as it is; only then are corners renamed.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> renamed;
  for (std::size_t v = 0; v < n; ++v) {
    const std::uint32_t count = first[v + 1] - first[v];
    if (count < 2) continue;
    UnionFind fans(count);
    for (std::uint32_t i = 0; i < count; ++i)
      for (std::uint32_t j = 0; j < count; ++j) {
        const std::uint32_t a = corner[first[v] + i], b = corner[first[v] + j];
        if (mesh.triangles[a / 3][(a % 3 + 1) % 3] == mesh.triangles[b / 3][(b % 3 + 2) % 3]) fans.join(i, j);
      }
    std::vector<std::uint32_t> copy(count, kNoVertex);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t fan = fans.find(i);
      if (fan == fans.find(0)) continue;
      if (copy[fan] == kNoVertex) {
        copy[fan] = append_vertex_copy(mesh, static_cast<std::uint32_t>(v));
      }
      renamed.emplace_back(corner[first[v] + i], copy[fan]);
    }
  }
  for (const auto& [c, v] : renamed) mesh.triangles[c / 3][c % 3] = v;
}

}  // namespace sansmesh
