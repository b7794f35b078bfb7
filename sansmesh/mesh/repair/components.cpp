#include "sansmesh/mesh/repair/components.h"

#include <array>
#include <cstdint>

#include "sansmesh/core/largest_first.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh/mesh_vertices.h"
#include "sansmesh/mesh/vertex_corners.h"

namespace sansmesh::inline v1 {
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
  number_largest_first(result.of_triangle, result.area);
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

std::vector<TriangleMesh> split_components(const TriangleMesh& mesh, const MeshComponents& components) {
  const std::size_t parts = components.size();
  std::vector<std::uint32_t> part_of(mesh.vertices.size(), kNoVertex);  // components share no vertices
  std::vector<std::vector<std::uint32_t>> triangles(parts), vertices(parts);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t c = components.of_triangle[i];
    triangles[c].push_back(static_cast<std::uint32_t>(i));
    for (const std::uint32_t v : mesh.triangles[i]) part_of[v] = c;
  }
  std::vector<std::uint32_t> renumber(mesh.vertices.size());
  for (std::size_t v = 0; v < part_of.size(); ++v) {
    if (part_of[v] == kNoVertex) continue;
    renumber[v] = static_cast<std::uint32_t>(vertices[part_of[v]].size());
    vertices[part_of[v]].push_back(static_cast<std::uint32_t>(v));
  }
  std::vector<TriangleMesh> result(parts);
  parallel_for(0, parts, 1, [&](std::size_t c) {
    TriangleMesh& part = result[c];
    part.origin = mesh.origin;
    part.reference = mesh.reference;
    part.vertices.reserve(vertices[c].size());
    for (const std::uint32_t v : vertices[c]) {
      part.vertices.push_back(mesh.vertices[v]);
      if (!mesh.normals.empty()) part.normals.push_back(mesh.normals[v]);
      if (!mesh.colors.empty()) part.colors.push_back(mesh.colors[v]);
    }
    part.attributes = mesh.attributes.taken(vertices[c]);
    part.triangle_attributes = mesh.triangle_attributes.taken(triangles[c]);
    part.triangles.reserve(triangles[c].size());
    for (const std::uint32_t i : triangles[c]) {
      const Triangle& t = mesh.triangles[i];
      part.triangles.push_back({renumber[t[0]], renumber[t[1]], renumber[t[2]]});
    }
  });
  return result;
}

namespace {

/// For each vertex, whether its triangles are certainly one fan; tests at most as many triangles as bits in a word,
/// which covers nearly all vertices.
std::vector<std::uint8_t> one_fan_each(const TriangleMesh& mesh, const VertexCorners& corners) {
  std::vector<std::uint8_t> result(mesh.vertices.size());
  parallel_for(0, result.size(), 4096, [&](std::size_t v) {
    const std::uint32_t begin = corners.first[v], count = corners.first[v + 1] - begin;
    if (count > 64) return;
    std::array<std::uint32_t, 64> out, back;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t c = corners.entries[begin + i];
      out[i] = mesh.triangles[c / 3][(c % 3 + 1) % 3], back[i] = mesh.triangles[c / 3][(c % 3 + 2) % 3];
    }
    const std::uint64_t all = count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
    std::uint64_t reached = all & 1, before = 0;
    while (reached != before) {
      before = reached;
      for (std::uint32_t i = 0; i < count; ++i)
        for (std::uint32_t j = 0; j < count; ++j)
          if (out[i] == back[j]) {
            if (reached >> i & 1) reached |= std::uint64_t{1} << j;
            if (reached >> j & 1) reached |= std::uint64_t{1} << i;
          }
    }
    result[v] = reached == all;
  });
  return result;
}

}  // namespace

void separate_fans(TriangleMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  const VertexCorners corners(mesh.triangles, n);
  const std::vector<std::uint32_t>&first = corners.first, &corner = corners.entries;
  // Finds all fans before renumbering corners.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> renamed;
  const std::vector<std::uint8_t> is_one = one_fan_each(mesh, corners);
  for (std::size_t v = 0; v < n; ++v) {
    if (is_one[v]) continue;
    const std::uint32_t count = first[v + 1] - first[v];
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

}  // namespace sansmesh::inline v1
