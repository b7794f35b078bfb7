#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>

#include "sansmesh/core/edge_key.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/edit/refine_edges.h"
#include "sansmesh/mesh/mesh_vertices.h"

namespace sansmesh::inline v1 {
namespace {

std::uint32_t add_middle(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b) {
  return append_vertex_between(mesh, a, b, 0.5f, Vec3f((Vec3(mesh.vertices[a]) + Vec3(mesh.vertices[b])) * 0.5));
}

}  // namespace

std::optional<std::size_t> split_edges(TriangleMesh& mesh,
                                       const std::function<bool(std::uint32_t, std::uint32_t)>& to_split,
                                       std::size_t most_triangles) {
  // Triangles become 2, 3 or 4, depending on the number of bisected edges.
  std::unordered_map<std::uint64_t, std::uint32_t> middles;
  const std::size_t n = mesh.vertices.size();
  const auto cut = [&](std::uint32_t a, std::uint32_t b) { return to_split(std::min(a, b), std::max(a, b)); };
  std::size_t after = mesh.triangles.size();
  for (const Triangle& t : mesh.triangles)
    if (t[0] < n && t[1] < n && t[2] < n)
      for (std::size_t k = 0; k < 3; ++k) after += cut(t[k], t[(k + 1) % 3]);
  if (after == mesh.triangles.size()) return 0;
  if (after > most_triangles) return std::nullopt;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    if (!cut(a, b)) return kNoVertex;
    const auto [at, fresh] = middles.try_emplace(edge_key(a, b), kNoVertex);
    if (fresh) at->second = add_middle(mesh, std::min(a, b), std::max(a, b));
    return at->second;
  };
  std::vector<Triangle> finer;
  finer.reserve(after);
  std::vector<std::uint32_t> of;  // original triangle of each part
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangles[i];
    of.resize(finer.size(), i == 0 ? 0 : static_cast<std::uint32_t>(i - 1));
    if (t[0] >= n || t[1] >= n || t[2] >= n) {
      finer.push_back(t);
      continue;
    }
    // Rotated so that bisected edges come first: ab, or ab and bc.
    Triangle c = t;
    std::array<std::uint32_t, 3> m{};
    for (std::size_t k = 0; k < 3; ++k) m[k] = middle(t[k], t[(k + 1) % 3]);
    const auto cuts = std::count_if(m.begin(), m.end(), [](std::uint32_t v) { return v != kNoVertex; });
    while ((cuts == 1 && m[0] == kNoVertex) || (cuts == 2 && m[2] != kNoVertex)) {
      std::rotate(c.begin(), c.begin() + 1, c.end());
      std::rotate(m.begin(), m.begin() + 1, m.end());
    }
    if (cuts == 0) finer.push_back(c);
    if (cuts == 1) finer.insert(finer.end(), {{c[0], m[0], c[2]}, {m[0], c[1], c[2]}});
    if (cuts == 2) finer.insert(finer.end(), {{m[0], c[1], m[1]}, {c[0], m[0], m[1]}, {c[0], m[1], c[2]}});
    if (cuts == 3)
      finer.insert(finer.end(), {{c[0], m[0], m[2]}, {m[0], c[1], m[1]}, {m[2], m[1], c[2]}, {m[0], m[1], m[2]}});
  }
  of.resize(finer.size(), static_cast<std::uint32_t>(mesh.triangles.size() - 1));
  const std::size_t added = finer.size() - mesh.triangles.size();
  mesh.triangles = std::move(finer);
  if (!mesh.triangle_attributes.empty()) mesh.triangle_attributes = mesh.triangle_attributes.taken(of);
  return added;
}

bool refine_edges(TriangleMesh& mesh, double length, std::size_t most_triangles) {
  if (!(length > 0) || !std::isfinite(length))
    throw ArgumentError("the length to refine edges to must be positive, not " + std::to_string(length));
  const auto too_long = [&](std::uint32_t a, std::uint32_t b) {
    const double d = norm(Vec3(mesh.vertices[a]) - Vec3(mesh.vertices[b]));
    return std::isfinite(d) && d > length;
  };
  for (;;) {
    const std::optional<std::size_t> added = split_edges(mesh, too_long, most_triangles);
    if (!added) return false;
    if (*added == 0) return true;
  }
}

}  // namespace sansmesh::inline v1
