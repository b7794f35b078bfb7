#include "sansmesh/mesh/edit/replace_region.h"

#include <algorithm>
#include <limits>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/mesh/mesh_vertices.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

/// Of each vertex whether it lies in one of the boxes.
std::vector<std::uint8_t> vertices_in(const std::vector<Box3f>& boxes, const TriangleMesh& mesh) {
  std::vector<std::uint8_t> result(mesh.vertices.size());
  parallel_for(0, result.size(), 4096, [&](std::size_t v) { result[v] = any_contains(boxes, mesh.vertices[v]); });
  return result;
}

bool inside(const std::vector<std::uint8_t>& in, const Triangle& t) { return in[t[0]] && in[t[1]] && in[t[2]]; }

Box3f box_of(const TriangleMesh& mesh, const Triangle& t) {
  Box3f b;
  for (const std::uint32_t v : t) b.extend(mesh.vertices[v]);
  return b;
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
std::vector<std::uint32_t> same_vertices(const TriangleMesh& mesh, const TriangleMesh& patch,
                                         const std::vector<std::uint8_t>& in, float tolerance) {
  std::vector<Vec3f> near;
  std::vector<std::uint32_t> number;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (in[v]) near.push_back(mesh.vertices[v]), number.push_back(static_cast<std::uint32_t>(v));
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

RegionReplacement replace_region(TriangleMesh& mesh, const TriangleMesh& patch, const std::vector<Box3f>& sound,
                                 const std::vector<Box3f>& changed, float tolerance, double least_agreement) {
  RegionReplacement result;
  result.spoiled.assign(changed.size(), 1);
  const std::vector<std::uint8_t> mesh_in = vertices_in(sound, mesh), patch_in = vertices_in(sound, patch);
  const std::vector<std::uint32_t> same = same_vertices(mesh, patch, mesh_in, tolerance);

  std::unordered_map<Triangle, std::uint32_t, TriangleHash> of_mesh;
  std::vector<std::uint32_t> in_box;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!inside(mesh_in, mesh.triangles[i])) continue;
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
    const bool counts = inside(patch_in, t) && !any_touches(changed, box_of(patch, t));
    off += counts;
    if (found == of_mesh.end()) {
      singles.push_back({static_cast<std::uint32_t>(i), true});
    } else {
      shared.insert(found->second);
      agreed += counts;
    }
  }
  result.agreement = off > 0 ? static_cast<double>(agreed) / static_cast<double>(off) : 1;
  if (result.agreement < least_agreement) return result;
  for (const std::uint32_t i : in_box)
    if (!shared.count(i)) singles.push_back({i, false});
  // Triangles of the mesh that cross the border of the box are only of interest as what a piece must not reach.
  std::vector<std::uint8_t> rim(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles)
    if (!inside(mesh_in, t))
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
    if (any_touches(changed, box_of(of, of.triangles[s.triangle]))) wanted[piece] = 1;
    if (s.of_patch) {
      if (!inside(patch_in, patch.triangles[s.triangle])) spoiled[piece] = 1;
      for (const std::uint32_t v : patch.triangles[s.triangle]) spoiled[piece] |= same[v] != kNoVertex && rim[same[v]];
    } else {
      for (const std::uint32_t v : mesh.triangles[s.triangle]) spoiled[piece] |= rim[v];
    }
  }
  // Pieces that reach out stay as they are, and with them all changes that they touch are not done.
  result.spoiled.assign(changed.size(), 0);
  for (std::size_t i = 0; i < singles.size(); ++i) {
    const std::uint32_t piece = pieces.find(static_cast<std::uint32_t>(i));
    if (!wanted[piece] || !spoiled[piece]) continue;
    const TriangleMesh& of = singles[i].of_patch ? patch : mesh;
    const Box3f b = box_of(of, of.triangles[singles[i].triangle]);
    for (std::size_t k = 0; k < changed.size(); ++k)
      if (touch(changed[k], b)) result.spoiled[k] = 1;
  }
  result.done = std::find(result.spoiled.begin(), result.spoiled.end(), 1) == result.spoiled.end();

  // Exchange.
  std::vector<std::uint8_t> keep(mesh.triangles.size(), 1);
  std::vector<std::uint32_t> new_number(patch.vertices.size(), kNoVertex), new_vertices;
  for (std::size_t v = 0; v < same.size(); ++v) new_number[v] = same[v];
  std::vector<Triangle> added;
  std::vector<std::uint32_t> taken;  // triangles of the patch
  for (std::size_t i = 0; i < singles.size(); ++i) {
    const std::uint32_t piece = pieces.find(static_cast<std::uint32_t>(i));
    if (!wanted[piece] || spoiled[piece]) continue;
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
  if (result.removed == 0 && added.empty()) return result;
  append_vertices(mesh, patch, new_vertices);
  mesh.triangle_attributes.append(patch.triangle_attributes, taken);
  mesh.triangles.insert(mesh.triangles.end(), added.begin(), added.end());
  keep.resize(mesh.triangles.size(), 1);
  keep_triangles(mesh, keep);
  return result;
}

}  // namespace sansmesh::inline v1
