#include "sansmesh/function/mesh_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "sansmesh/core/edge_key.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/search/equal_positions.h"

namespace sansmesh::inline v1 {
namespace {

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

/// Half-edges 3 · triangle + k with two ends, ordered by their ends, the smaller index first.
std::vector<KeyIndex> ordered_half_edges(const std::vector<Triangle>& triangles) {
  std::vector<KeyIndex> keys;
  keys.reserve(3 * triangles.size());
  for (std::uint32_t h = 0; h < 3 * triangles.size(); ++h) {
    const std::uint32_t a = triangles[h / 3][h % 3], b = triangles[h / 3][(h % 3 + 1) % 3];
    if (a != b) keys.push_back({edge_key(a, b), h});
  }
  parallel_sort(keys);
  return keys;
}

/// Finds the creases of a mesh, joins them to curves, and numbers patches, curves and corners.
class PatchFinder {
 public:
  PatchFinder(const TriangleMesh& mesh, MeshPatches& patches)
      : mesh_(mesh), patches_(patches), faces_(patches.triangles.size()) {}

  void find_creases(double cosine);
  /// Creases that meet in pairs are one curve. Short curves with free ends are removed, and the rest is processed
  /// again.
  void find_curves(double least_crease);
  void number();

 private:
  std::array<std::uint32_t, 2> ends(std::uint32_t h) const {
    const Triangle& t = patches_.triangles[h / 3];
    return {t[h % 3], t[(h % 3 + 1) % 3]};
  }
  float squared_length(std::uint32_t h) const {
    const auto [a, b] = ends(h);
    return squared_norm(mesh_.vertices[a] - mesh_.vertices[b]);
  }
  bool is_longest(std::uint32_t h) const {
    for (std::uint32_t k = 0; k < 3; ++k)
      if (squared_length(h / 3 * 3 + k) > squared_length(h)) return false;
    return true;
  }
  bool is_smooth(std::span<const KeyIndex> half_edges, double cosine);
  void chain_creases();
  bool remove_short_curves(double least_crease);

  const TriangleMesh& mesh_;
  MeshPatches& patches_;
  UnionFind faces_;
  std::vector<std::uint32_t> creases_;  ///< one half-edge of each crease
  std::vector<std::uint32_t> chain_;    ///< curve of each crease; kSmooth: removed
  std::vector<std::uint8_t> count_;     ///< number of creases at each vertex, at most 3
  std::vector<std::uint32_t> first_;    ///< first crease at each vertex with two
};

/// Classifies an edge by its half-edges; true if it is no crease.
bool PatchFinder::is_smooth(std::span<const KeyIndex> half_edges, double cosine) {
  MeshPatches& p = patches_;
  ++p.edges.edges;
  if (half_edges.size() == 1) {
    ++p.edges.open;
    p.open.push_back(half_edges[0].index);
    return false;
  }
  if (half_edges.size() > 2) {
    ++p.edges.tangled;
    return false;
  }
  const std::uint32_t h = half_edges[0].index, g = half_edges[1].index, t = h / 3, u = g / 3;
  bool smooth = false;
  if (ends(h) == ends(g)) {
    ++p.edges.tangled;
  } else if (p.normal[t] == Vec3{} || p.normal[u] == Vec3{}) {
    // Without area: it belongs to the triangle behind its longest edge.
    smooth = is_longest(p.normal[t] == Vec3{} ? h : g);
  } else {
    smooth = dot(p.normal[t], p.normal[u]) >= cosine;
  }
  p.across[h] = u, p.across[g] = t;
  if (smooth) faces_.join(t, u);
  return smooth;
}

void PatchFinder::find_creases(double cosine) {
  patches_.curve.assign(3 * patches_.triangles.size(), MeshPatches::kSmooth);
  patches_.across.assign(3 * patches_.triangles.size(), MeshPatches::kSmooth);
  const std::vector<KeyIndex> all = ordered_half_edges(patches_.triangles);
  for (std::size_t i = 0, j; i < all.size(); i = j) {
    for (j = i; j < all.size() && all[j].key == all[i].key; ++j) {
    }
    if (is_smooth(std::span(all).subspan(i, j - i), cosine)) continue;
    for (std::size_t k = i; k < j; ++k) patches_.curve[all[k].index] = static_cast<std::uint32_t>(creases_.size());
    creases_.push_back(all[i].index);
  }
  chain_.assign(creases_.size(), 0);
}

void PatchFinder::chain_creases() {
  count_.assign(mesh_.vertices.size(), 0);
  first_.assign(mesh_.vertices.size(), MeshPatches::kSmooth);
  UnionFind chains(creases_.size());
  for (std::uint32_t c = 0; c < creases_.size(); ++c)
    if (chain_[c] != MeshPatches::kSmooth)
      for (const std::uint32_t v : ends(creases_[c])) count_[v] = static_cast<std::uint8_t>(std::min(3, count_[v] + 1));
  for (std::uint32_t c = 0; c < creases_.size(); ++c) {
    if (chain_[c] == MeshPatches::kSmooth) continue;
    for (const std::uint32_t v : ends(creases_[c])) {
      if (count_[v] != 2) continue;
      if (first_[v] == MeshPatches::kSmooth) {
        first_[v] = c;
      } else {
        chains.join(first_[v], c);
      }
    }
  }
  patches_.curves = number_sets(chains, chain_);
}

/// Returns whether any was removed.
bool PatchFinder::remove_short_curves(double least_crease) {
  std::vector<double> length(patches_.curves, 0);
  std::vector<std::uint8_t> free_end(patches_.curves, 0), closed(patches_.curves, 1);
  for (std::uint32_t c = 0; c < creases_.size(); ++c) {
    if (chain_[c] == MeshPatches::kSmooth) continue;
    length[chain_[c]] += std::sqrt(static_cast<double>(squared_length(creases_[c])));
    if (patches_.across[creases_[c]] == MeshPatches::kSmooth) length[chain_[c]] = least_crease;
    for (const std::uint32_t v : ends(creases_[c])) {
      if (count_[v] == 1) closed[chain_[c]] = 0, free_end[chain_[c]] = 1;
      if (count_[v] > 2) closed[chain_[c]] = 0;
    }
  }
  bool removed = false;
  for (std::uint32_t c = 0; c < creases_.size(); ++c) {
    const std::uint32_t curve = chain_[c];
    if (curve == MeshPatches::kSmooth || length[curve] >= least_crease || (!free_end[curve] && !closed[curve]))
      continue;
    chain_[c] = MeshPatches::kSmooth;
    removed = true;
    faces_.join(creases_[c] / 3, patches_.across[creases_[c]]);
  }
  return removed;
}

void PatchFinder::find_curves(double least_crease) {
  do {
    chain_creases();
  } while (least_crease > 0 && remove_short_curves(least_crease));
}

void PatchFinder::number() {
  MeshPatches& p = patches_;
  p.patch.assign(p.triangles.size(), 0);
  p.patches = number_sets(faces_, p.patch);
  for (std::uint32_t& c : p.curve)
    if (c != MeshPatches::kSmooth) c = chain_[c];
  p.feature.assign(mesh_.vertices.size(), MeshPatches::kSmooth);
  for (std::uint32_t v = 0; v < count_.size(); ++v) {
    if (count_[v] == 2) p.feature[v] = chain_[first_[v]];
    if (count_[v] == 1 || count_[v] > 2) p.feature[v] = p.curves + p.corners++;
  }
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
  PatchFinder finder(mesh, *this);
  finder.find_creases(std::cos(crease_angle * std::numbers::pi / 180));
  finder.find_curves(least_crease);
  finder.number();
}

}  // namespace sansmesh::inline v1
