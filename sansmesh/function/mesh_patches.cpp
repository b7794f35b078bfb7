#include "sansmesh/function/mesh_patches.h"
#include "sansmesh/core/edge_key.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sansmesh/core/edge_key.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/search/equal_positions.h"

namespace sansmesh::inline v1 {
namespace {

struct MeshEdge {
  std::uint64_t ends;       ///< both vertices, the smaller index first
  std::uint32_t half_edge;  ///< 3 · triangle + k
};

/// Numbers the roots of some sets in their order; the others keep kSmooth.
std::uint32_t number_sets(UnionFind& sets, std::vector<std::uint32_t>& of) {
  std::vector<std::uint32_t> number(of.size(), MeshPatches::kSmooth);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (of[i] == MeshPatches::kSmooth) continue;
    std::uint32_t& n = number[sets.find(static_cast<std::uint32_t>(i))];
    if (n == MeshPatches::kSmooth) n = count++;
    of[i] = n;
  }
  return count;
}

}  // namespace

MeshPatches::MeshPatches(const TriangleMesh& mesh, double crease_angle, double least_crease) {
  const std::vector<std::uint32_t> same = first_equal_positions(mesh.vertices);
  const std::size_t n = mesh.triangles.size();
  triangles.resize(n);
  normal.resize(n);
  parallel_for(0, n, 4096, [&](std::size_t t) {
    for (std::size_t k = 0; k < 3; ++k) triangles[t][k] = same[mesh.triangles[t][k]];
    const Vec3 a(mesh.vertices[triangles[t][0]]), b(mesh.vertices[triangles[t][1]]), c(mesh.vertices[triangles[t][2]]);
    normal[t] = normalized(cross(b - a, c - a));
  });
  std::vector<MeshEdge> all;
  all.reserve(3 * n);
  for (std::uint32_t t = 0; t < n; ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      if (a != b) all.push_back({edge_key(a, b), 3 * t + k});
    }
  std::sort(all.begin(), all.end(), [](const MeshEdge& a, const MeshEdge& b) {
    return a.ends != b.ends ? a.ends < b.ends : a.half_edge < b.half_edge;
  });

  const double cosine = std::cos(crease_angle * std::numbers::pi / 180);
  const auto length2 = [&](std::uint32_t h) {
    return squared_norm(mesh.vertices[triangles[h / 3][h % 3]] - mesh.vertices[triangles[h / 3][(h % 3 + 1) % 3]]);
  };
  const auto longest = [&](std::uint32_t h) {
    for (std::uint32_t k = 0; k < 3; ++k)
      if (length2(h / 3 * 3 + k) > length2(h)) return false;
    return true;
  };
  UnionFind faces(n);
  std::vector<std::uint32_t> creases;  // one half-edge of each crease
  curve.assign(3 * n, kSmooth);
  across.assign(3 * n, kSmooth);
  for (std::size_t i = 0, j; i < all.size(); i = j) {
    for (j = i; j < all.size() && all[j].ends == all[i].ends; ++j) {
    }
    ++edges.edges;
    bool smooth = false;
    if (j - i == 1) {
      ++edges.open;
      open.push_back(all[i].half_edge);
    } else if (j - i > 2) {
      ++edges.tangled;
    } else {
      const std::uint32_t h = all[i].half_edge, g = all[i + 1].half_edge, t = h / 3, u = g / 3;
      if (triangles[t][h % 3] == triangles[u][g % 3]) {
        ++edges.tangled;
      } else if (normal[t] == Vec3{} || normal[u] == Vec3{}) {
        // Without area: it belongs to the triangle behind its longest edge.
        smooth = longest(normal[t] == Vec3{} ? h : g);
      } else {
        smooth = dot(normal[t], normal[u]) >= cosine;
      }
      across[h] = u, across[g] = t;
      if (smooth) faces.join(t, u);
    }
    if (smooth) continue;
    for (std::size_t k = i; k < j; ++k) curve[all[k].half_edge] = static_cast<std::uint32_t>(creases.size());
    creases.push_back(all[i].half_edge);
  }
  // Creases that meet in pairs are one curve. Short curves with free ends are removed, and the rest is processed again.
  place.assign(mesh.vertices.size(), kSmooth);
  std::vector<std::uint8_t> count;
  std::vector<std::uint32_t> first, chain(creases.size(), 0);
  const auto ends = [&](std::uint32_t c) {
    const std::uint32_t h = creases[c];
    return std::array<std::uint32_t, 2>{triangles[h / 3][h % 3], triangles[h / 3][(h % 3 + 1) % 3]};
  };
  for (bool again = true; again;) {
    again = false;
    count.assign(mesh.vertices.size(), 0);
    first.assign(mesh.vertices.size(), kSmooth);
    UnionFind chains(creases.size());
    for (std::uint32_t c = 0; c < creases.size(); ++c)
      if (chain[c] != kSmooth)
        for (const std::uint32_t v : ends(c)) count[v] = static_cast<std::uint8_t>(std::min(3, count[v] + 1));
    for (std::uint32_t c = 0; c < creases.size(); ++c) {
      if (chain[c] == kSmooth) continue;
      for (const std::uint32_t v : ends(c)) {
        if (count[v] != 2) continue;
        if (first[v] == kSmooth) {
          first[v] = c;
        } else {
          chains.join(first[v], c);
        }
      }
    }
    curves = number_sets(chains, chain);
    if (!(least_crease > 0)) break;
    std::vector<double> length(curves, 0);
    std::vector<std::uint8_t> free_end(curves, 0), closed(curves, 1);
    for (std::uint32_t c = 0; c < creases.size(); ++c) {
      if (chain[c] == kSmooth) continue;
      length[chain[c]] += std::sqrt(static_cast<double>(length2(creases[c])));
      if (across[creases[c]] == kSmooth) length[chain[c]] = least_crease;
      for (const std::uint32_t v : ends(c)) {
        if (count[v] == 1) closed[chain[c]] = 0, free_end[chain[c]] = 1;
        if (count[v] > 2) closed[chain[c]] = 0;
      }
    }
    for (std::uint32_t c = 0; c < creases.size(); ++c) {
      const std::uint32_t h = creases[c];
      if (chain[c] == kSmooth || length[chain[c]] >= least_crease || (!free_end[chain[c]] && !closed[chain[c]]))
        continue;
      chain[c] = kSmooth;
      again = true;
      faces.join(h / 3, across[h]);
    }
  }
  patch.assign(n, 0);
  patches = number_sets(faces, patch);
  for (std::uint32_t& c : curve)
    if (c != kSmooth) c = chain[c];
  for (std::uint32_t v = 0; v < count.size(); ++v) {
    if (count[v] == 2) place[v] = chain[first[v]];
    if (count[v] == 1 || count[v] > 2) place[v] = curves + corners++;
  }
}

}  // namespace sansmesh::inline v1
