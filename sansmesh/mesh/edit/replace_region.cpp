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

/// For each vertex, whether it is in one of the boxes.
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

/// Rotates the least vertex to the front, as a canonical form.
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

/// Coincident vertex of the mesh for each vertex of the patch; kNoVertex if there is none.
std::vector<std::uint32_t> same_vertices(const TriangleMesh& mesh, const TriangleMesh& patch,
                                         const std::vector<std::uint8_t>& in, float tolerance) {
  std::vector<Vec3f> near;
  std::vector<std::uint32_t> number;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (in[v]) near.push_back(mesh.vertices[v]), number.push_back(static_cast<std::uint32_t>(v));
  std::vector<std::uint32_t> same(patch.vertices.size(), kNoVertex);
  if (near.empty()) return same;
  const KdTree tree(near);
  // One-to-one: if triangles are smaller than the tolerance, the nearest pair wins.
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

/// Exchange of the pieces that differ between a mesh and a patch of it.
class RegionExchange {
 public:
  RegionExchange(TriangleMesh& mesh, const TriangleMesh& patch, const std::vector<Box3f>& sound,
                 const std::vector<Box3f>& changed, float tolerance)
      : mesh_(mesh),
        patch_(patch),
        changed_(changed),
        mesh_in_(vertices_in(sound, mesh)),
        patch_in_(vertices_in(sound, patch)),
        same_(same_vertices(mesh, patch, mesh_in_, tolerance)),
        pieces_(0) {}

  /// Finds the triangles that only one of the two has; returns their agreement away from the changes.
  double compare() {
    std::unordered_map<Triangle, std::uint32_t, TriangleHash> of_mesh;
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i)
      if (inside(mesh_in_, mesh_.triangles[i])) of_mesh.emplace(rotated(mesh_.triangles[i]), i);
    std::unordered_set<std::uint32_t> shared;
    std::size_t off = 0, agreed = 0;
    for (std::uint32_t i = 0; i < patch_.triangles.size(); ++i) {
      const Triangle& t = patch_.triangles[i];
      const Triangle m{same_[t[0]], same_[t[1]], same_[t[2]]};
      const bool known = m[0] != kNoVertex && m[1] != kNoVertex && m[2] != kNoVertex;
      const auto found = known ? of_mesh.find(rotated(m)) : of_mesh.end();
      const bool counts = inside(patch_in_, t) && !any_touches(changed_, box_of(patch_, t));
      off += counts;
      if (found == of_mesh.end()) {
        singles_.push_back({i, true});
      } else {
        shared.insert(found->second);
        agreed += counts;
      }
    }
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i)
      if (inside(mesh_in_, mesh_.triangles[i]) && !shared.count(i)) singles_.push_back({i, false});
    return off > 0 ? static_cast<double>(agreed) / static_cast<double>(off) : 1;
  }

  /// Joins unmatched triangles of either mesh with common vertices to pieces, and selects those that touch a change.
  void find_pieces() {
    pieces_ = UnionFind(singles_.size());
    std::unordered_map<std::size_t, std::uint32_t> first_at;
    const auto vertex = [&](const Single& s, std::size_t k) -> std::size_t {
      const std::uint32_t v = triangle(s)[k];
      if (!s.of_patch) return v;
      return same_[v] != kNoVertex ? same_[v] : mesh_.vertices.size() + v;
    };
    for (std::uint32_t i = 0; i < singles_.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [entry, is_new] = first_at.try_emplace(vertex(singles_[i], k), i);
        if (!is_new) pieces_.join(entry->second, i);
      }
    // Triangles of the mesh across the border of the box matter only as a limit that pieces must not reach.
    std::vector<std::uint8_t> rim(mesh_.vertices.size(), 0);
    for (const Triangle& t : mesh_.triangles)
      if (!inside(mesh_in_, t))
        for (const std::uint32_t v : t) rim[v] = 1;
    wanted_.resize(singles_.size());
    spoiled_.resize(singles_.size());
    for (std::uint32_t i = 0; i < singles_.size(); ++i) {
      const Single& s = singles_[i];
      const std::uint32_t piece = pieces_.find(i);
      if (any_touches(changed_, box(s))) wanted_[piece] = 1;
      if (s.of_patch && !inside(patch_in_, triangle(s))) spoiled_[piece] = 1;
      for (const std::uint32_t v : triangle(s)) {
        const std::uint32_t at = s.of_patch ? same_[v] : v;
        spoiled_[piece] |= at != kNoVertex && rim[at];
      }
    }
  }

  /// Changes touched by pieces that extend beyond the region: these pieces and changes stay as they are.
  std::vector<std::uint8_t> spoiled_changes() {
    std::vector<std::uint8_t> spoiled(changed_.size(), 0);
    for (std::uint32_t i = 0; i < singles_.size(); ++i) {
      const std::uint32_t piece = pieces_.find(i);
      if (!wanted_[piece] || !spoiled_[piece]) continue;
      for (std::size_t k = 0; k < changed_.size(); ++k)
        if (touch(changed_[k], box(singles_[i]))) spoiled[k] = 1;
    }
    return spoiled;
  }

  void exchange(RegionReplacement& result) {
    std::vector<std::uint8_t> keep(mesh_.triangles.size(), 1);
    std::vector<std::uint32_t> new_number = same_, new_vertices;
    std::vector<Triangle> added;
    std::vector<std::uint32_t> taken;  // triangles of the patch
    for (std::uint32_t i = 0; i < singles_.size(); ++i) {
      const Single& s = singles_[i];
      const std::uint32_t piece = pieces_.find(i);
      if (!wanted_[piece] || spoiled_[piece]) continue;
      if (!s.of_patch) {
        keep[s.triangle] = 0;
        ++result.removed;
        continue;
      }
      Triangle t = triangle(s);
      for (std::uint32_t& v : t) {
        if (new_number[v] == kNoVertex) {
          new_number[v] = static_cast<std::uint32_t>(mesh_.vertices.size() + new_vertices.size());
          new_vertices.push_back(v);
        }
        v = new_number[v];
      }
      added.push_back(t);
      taken.push_back(s.triangle);
    }
    result.added = added.size();
    if (result.removed == 0 && added.empty()) return;
    append_vertices(mesh_, patch_, new_vertices);
    mesh_.triangle_attributes.append(patch_.triangle_attributes, taken);
    mesh_.triangles.insert(mesh_.triangles.end(), added.begin(), added.end());
    keep.resize(mesh_.triangles.size(), 1);
    keep_triangles(mesh_, keep);
  }

 private:
  /// Triangle of one mesh that the other does not have.
  struct Single {
    std::uint32_t triangle;
    bool of_patch;
  };
  const TriangleMesh& mesh_of(const Single& s) const { return s.of_patch ? patch_ : mesh_; }
  const Triangle& triangle(const Single& s) const { return mesh_of(s).triangles[s.triangle]; }
  Box3f box(const Single& s) const { return box_of(mesh_of(s), triangle(s)); }

  TriangleMesh& mesh_;
  const TriangleMesh& patch_;
  const std::vector<Box3f>& changed_;
  std::vector<std::uint8_t> mesh_in_, patch_in_;  ///< whether each vertex is in the sound region
  std::vector<std::uint32_t> same_;               ///< vertex of the mesh for each vertex of the patch
  std::vector<Single> singles_;
  UnionFind pieces_;                            ///< groups of singles
  std::vector<std::uint8_t> wanted_, spoiled_;  ///< per piece, by its representative
};

}  // namespace

RegionReplacement replace_region(TriangleMesh& mesh, const TriangleMesh& patch, const std::vector<Box3f>& sound,
                                 const std::vector<Box3f>& changed, float tolerance, double least_agreement) {
  RegionReplacement result;
  RegionExchange region(mesh, patch, sound, changed, tolerance);
  result.agreement = region.compare();
  if (result.agreement < least_agreement) {
    result.spoiled.assign(changed.size(), 1);
    return result;
  }
  region.find_pieces();
  result.spoiled = region.spoiled_changes();
  result.done = std::find(result.spoiled.begin(), result.spoiled.end(), 1) == result.spoiled.end();
  region.exchange(result);
  return result;
}

}  // namespace sansmesh::inline v1
