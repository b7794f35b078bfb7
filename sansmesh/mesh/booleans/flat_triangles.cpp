#include "sansmesh/mesh/booleans/flat_triangles.h"

#include <cstdint>
#include <map>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/mesh/booleans/exact_points.h"

namespace sansmesh::inline v1 {
namespace {

/// Passes over flat triangles, each of which may be next to another.
constexpr int kPasses = 16;

bool repeats(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

std::vector<std::uint32_t> flat_ones(const SolidFaces& solid, const std::vector<Triangle>& triangles) {
  const ExactSpace space(solid.vertices);
  std::vector<std::uint8_t> flat(triangles.size());
  parallel_for(0, triangles.size(), 4096, [&](std::size_t t) {
    const auto [a, b, c] = triangles[t];
    flat[t] = repeats(triangles[t]) || space.main_axis(a, b, c) < 0 ? 1 : 0;
  });
  std::vector<std::uint32_t> found;
  for (std::uint32_t t = 0; t < flat.size(); ++t)
    if (flat[t] != 0) found.push_back(t);
  return found;
}

/// Gives ends of edges of length zero one vertex, and drops triangles that lose their edges.
void contract(const SolidFaces& solid, std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& flat) {
  UnionFind same(solid.vertices.size());
  for (const std::uint32_t t : flat)
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t a = triangles[t][e], b = triangles[t][(e + 1) % 3];
      if (solid.vertices[a] == solid.vertices[b]) same.join(a, b);
    }
  for (Triangle& t : triangles)
    for (std::uint32_t& v : t) v = same.find(v);
  std::erase_if(triangles, repeats);
}

/// Replaces the edge opposite to the middle corner of each flat triangle.
void flip(const SolidFaces& solid, std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& flat) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> at_edge;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t e = 0; e < 3; ++e) at_edge[{triangles[t][e], triangles[t][(e + 1) % 3]}] = t;
  std::vector<std::uint8_t> changed(triangles.size(), 0);
  for (const std::uint32_t t : flat) {
    std::size_t longest = 0;
    double length = -1;
    for (std::size_t e = 0; e < 3; ++e) {
      const double l = squared_norm(solid.vertices[triangles[t][(e + 1) % 3]] - solid.vertices[triangles[t][e]]);
      if (l > length) length = l, longest = e;
    }
    const std::uint32_t a = triangles[t][longest], b = triangles[t][(longest + 1) % 3],
                        c = triangles[t][(longest + 2) % 3];
    const auto other = at_edge.find({b, a});
    if (other == at_edge.end() || changed[t] != 0 || changed[other->second] != 0) continue;
    const Triangle& n = triangles[other->second];
    const std::uint32_t d = n[0] != a && n[0] != b ? n[0] : n[1] != a && n[1] != b ? n[1] : n[2];
    if (d == c) continue;
    changed[t] = changed[other->second] = 1;
    triangles[t] = {a, d, c};
    triangles[other->second] = {d, b, c};
  }
}

}  // namespace

std::vector<Triangle> without_flat_triangles(const SolidFaces& solid) {
  std::vector<Triangle> triangles = solid.triangles;
  std::vector<std::uint32_t> flat = flat_ones(solid, triangles);
  if (flat.empty()) return triangles;
  contract(solid, triangles, flat);
  for (int pass = 0; pass < kPasses && !(flat = flat_ones(solid, triangles)).empty(); ++pass)
    flip(solid, triangles, flat);
  // Flat ones that are left bound nothing, if their neighbours are flat, too.
  for (std::size_t i = flat.size(); i-- > 0;) triangles.erase(triangles.begin() + flat[i]);
  return triangles;
}

}  // namespace sansmesh::inline v1
