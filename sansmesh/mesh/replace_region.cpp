#include "sansmesh/mesh/replace_region.h"

#include <algorithm>
#include <limits>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "sansmesh/core/union_find.h"
#include "sansmesh/mesh/components.h"
#include "sansmesh/mesh/mesh_vertices.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh {
namespace {

bool inside(const TriangleMesh& mesh, const Triangle& t, const Box3f& box) {
  return box.contains(mesh.vertices[t[0]]) && box.contains(mesh.vertices[t[1]]) && box.contains(mesh.vertices[t[2]]);
}

bool touches(const TriangleMesh& mesh, const Triangle& t, const Box3f& box) {
  Box3f b;
  for (const std::uint32_t v : t) b.extend(mesh.vertices[v]);
  for (std::size_t k = 0; k < 3; ++k)
    if (b.upper[k] < box.lower[k] || b.lower[k] > box.upper[k]) return false;
  return true;
}

/// The triangle with its least vertex first: the same whichever corner it began with.
Triangle rotated(const Triangle& t) {
  if (t[0] < t[1] && t[0] < t[2]) return t;
  if (t[1] < t[2]) return {t[1], t[2], t[0]};
  return {t[2], t[0], t[1]};
}

struct TriangleHash {
  std::size_t operator()(const Triangle& t) const {
    std::uint64_t h = t[0] * 0x9e3779b97f4a7c15ULL;
    h = (h ^ t[1]) * 0xbf58476d1ce4e5b9ULL;
    h = (h ^ t[2]) * 0x94d049bb133111ebULL;
    return h ^ h >> 31;
  }
};

/// For each vertex of the patch the one of the mesh at the same place; kNoVertex where there is none.
std::vector<std::uint32_t> same_vertices(const TriangleMesh& mesh, const TriangleMesh& patch, const Box3f& box,
                                         float tolerance) {
  std::vector<Vec3f> near;
  std::vector<std::uint32_t> number;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (box.contains(mesh.vertices[v]))
      near.push_back(mesh.vertices[v]), number.push_back(static_cast<std::uint32_t>(v));
  std::vector<std::uint32_t> same(patch.vertices.size(), kNoVertex);
  if (near.empty()) return same;
  const KdTree tree(near);
  // One to one: where triangles are smaller than the tolerance the nearest pair wins.
  std::vector<std::uint32_t> taken(near.size(), kNoVertex);
  std::vector<float> distance(near.size(), std::numeric_limits<float>::infinity());
  for (std::size_t v = 0; v < same.size(); ++v) {
    const auto found = tree.nearest(patch.vertices[v]);
    if (!found || found->squared_distance > tolerance * tolerance || found->squared_distance >= distance[found->index])
      continue;
    if (taken[found->index] != kNoVertex) same[taken[found->index]] = kNoVertex;
    taken[found->index] = static_cast<std::uint32_t>(v);
    distance[found->index] = found->squared_distance;
    same[v] = number[found->index];
  }
  return same;
}

/// A triangle of either mesh that the other one does not have.
struct Single {
  std::uint32_t triangle;
  bool of_patch;
};

}  // namespace

RegionReplacement replace_region(TriangleMesh& mesh, const TriangleMesh& patch, const Box3f& sound,
                                 const Box3f& changed, float tolerance) {
  RegionReplacement result;
  const std::vector<std::uint32_t> same = same_vertices(mesh, patch, sound, tolerance);

  std::unordered_map<Triangle, std::uint32_t, TriangleHash> of_mesh;
  std::vector<std::uint32_t> in_box;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!inside(mesh, mesh.triangles[i], sound)) continue;
    in_box.push_back(static_cast<std::uint32_t>(i));
    of_mesh.emplace(rotated(mesh.triangles[i]), static_cast<std::uint32_t>(i));
  }
  std::unordered_set<std::uint32_t> shared;
  std::vector<Single> singles;
  std::size_t off = 0, agreed = 0;
  for (std::size_t i = 0; i < patch.triangles.size(); ++i) {
    const Triangle& t = patch.triangles[i];
    const Triangle m{same[t[0]], same[t[1]], same[t[2]]};
    const bool known = m[0] != kNoVertex && m[1] != kNoVertex && m[2] != kNoVertex;
    const auto found = known ? of_mesh.find(rotated(m)) : of_mesh.end();
    const bool counts = inside(patch, t, sound) && !touches(patch, t, changed);
    off += counts;
    if (found == of_mesh.end()) {
      singles.push_back({static_cast<std::uint32_t>(i), true});
    } else {
      shared.insert(found->second);
      agreed += counts;
    }
  }
  result.agreement = off > 0 ? static_cast<double>(agreed) / static_cast<double>(off) : 1;
  for (const std::uint32_t i : in_box)
    if (!shared.count(i)) singles.push_back({i, false});
  // Triangles of the mesh that cross the border of the box are only of interest as what a piece must not reach.
  std::vector<std::uint8_t> rim(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles)
    if (!inside(mesh, t, sound))
      for (const std::uint32_t v : t) rim[v] = 1;

  // Pieces: singles that share a vertex, whichever mesh they belong to.
  const std::size_t n = mesh.vertices.size();
  UnionFind pieces(singles.size());
  std::unordered_map<std::size_t, std::uint32_t> first_at;
  const auto vertex = [&](const Single& s, std::size_t k) -> std::size_t {
    if (!s.of_patch) return mesh.triangles[s.triangle][k];
    const std::uint32_t v = patch.triangles[s.triangle][k];
    return same[v] != kNoVertex ? same[v] : n + v;
  };
  for (std::size_t i = 0; i < singles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [entry, is_new] = first_at.try_emplace(vertex(singles[i], k), static_cast<std::uint32_t>(i));
      if (!is_new) pieces.join(entry->second, static_cast<std::uint32_t>(i));
    }
  std::vector<std::uint8_t> wanted(singles.size(), 0), spoiled(singles.size(), 0);
  for (std::size_t i = 0; i < singles.size(); ++i) {
    const Single& s = singles[i];
    const TriangleMesh& of = s.of_patch ? patch : mesh;
    const std::uint32_t piece = pieces.find(static_cast<std::uint32_t>(i));
    if (touches(of, of.triangles[s.triangle], changed)) wanted[piece] = 1;
    if (s.of_patch) {
      if (!inside(patch, patch.triangles[s.triangle], sound)) spoiled[piece] = 1;
      for (const std::uint32_t v : patch.triangles[s.triangle]) spoiled[piece] |= same[v] != kNoVertex && rim[same[v]];
    } else {
      for (const std::uint32_t v : mesh.triangles[s.triangle]) spoiled[piece] |= rim[v];
    }
  }
  for (std::size_t i = 0; i < singles.size(); ++i)
    if (wanted[i] && spoiled[i]) return result;

  // Exchange.
  std::vector<std::uint8_t> keep(mesh.triangles.size(), 1);
  std::vector<std::uint32_t> new_number(patch.vertices.size(), kNoVertex), new_vertices;
  for (std::size_t v = 0; v < same.size(); ++v) new_number[v] = same[v];
  std::vector<Triangle> added;
  std::vector<std::uint32_t> taken;  // triangles of the patch
  for (std::size_t i = 0; i < singles.size(); ++i) {
    if (!wanted[pieces.find(static_cast<std::uint32_t>(i))]) continue;
    const Single& s = singles[i];
    if (!s.of_patch) {
      keep[s.triangle] = 0;
      ++result.removed;
      continue;
    }
    Triangle t = patch.triangles[s.triangle];
    for (std::uint32_t& v : t) {
      if (new_number[v] == kNoVertex) {
        new_number[v] = static_cast<std::uint32_t>(n + new_vertices.size());
        new_vertices.push_back(v);
      }
      v = new_number[v];
    }
    added.push_back(t);
    taken.push_back(s.triangle);
  }
  result.added = added.size();
  result.done = true;
  if (result.removed == 0 && added.empty()) return result;
  append_vertices(mesh, patch, new_vertices);
  mesh.triangle_attributes.append(patch.triangle_attributes, taken);
  mesh.triangles.insert(mesh.triangles.end(), added.begin(), added.end());
  keep.resize(mesh.triangles.size(), 1);
  keep_triangles(mesh, keep);
  return result;
}

}  // namespace sansmesh
