#include "sansmesh/mesh/repair/sewn_mesh.h"
#include "sansmesh/core/edge_key.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/search/equal_positions.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kSewnChunk = 8192;

using SeamEdge = std::array<std::uint32_t, 2>;

/// Edges of exactly one triangle.
std::vector<SeamEdge> seam_edges(const std::vector<Triangle>& triangles) {
  std::vector<KeyIndex> edges(3 * triangles.size());
  parallel_for(0, triangles.size(), kSewnChunk, [&](std::size_t i) {
    const Triangle& t = triangles[i];
    for (std::size_t k = 0; k < 3; ++k)
      edges[3 * i + k] = {edge_key(t[k], t[(k + 1) % 3]), static_cast<unsigned>(3 * i + k)};
  });
  parallel_sort(edges);
  std::vector<SeamEdge> borders;
  for (std::size_t i = 0, j; i < edges.size(); i = j) {
    for (j = i + 1; j < edges.size() && edges[j].key == edges[i].key;) ++j;
    if (j == i + 1)
      borders.push_back({static_cast<std::uint32_t>(edges[i].key >> 32), static_cast<std::uint32_t>(edges[i].key)});
  }
  return borders;
}

}  // namespace

SewnMesh sewn_mesh(const TriangleMesh& mesh) {
  SewnMesh result;
  TriangleMesh& sewn = result.mesh;
  sewn.origin = mesh.origin;
  sewn.reference = mesh.reference;
  sewn.vertices = mesh.vertices;
  sewn.triangles.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    if (has_valid_corners(mesh.vertices, t) && has_distinct_corners(t)) sewn.triangles.push_back(t);

  const std::vector<SeamEdge> borders = seam_edges(sewn.triangles);
  // Only the ends of these edges can be joined.
  std::vector<std::uint32_t> ends;
  ends.reserve(2 * borders.size());
  for (const SeamEdge& e : borders) ends.insert(ends.end(), e.begin(), e.end());
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  std::vector<Vec3f> positions;
  positions.reserve(ends.size());
  for (const std::uint32_t v : ends) positions.push_back(mesh.vertices[v]);
  const std::vector<std::uint32_t> first = first_equal_positions(positions);
  const auto number = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(std::lower_bound(ends.begin(), ends.end(), v) - ends.begin());
  };
  std::vector<KeyIndex> lying(borders.size());
  for (std::size_t i = 0; i < borders.size(); ++i)
    lying[i] = {edge_key(first[number(borders[i][0])], first[number(borders[i][1])]), static_cast<unsigned>(i)};
  parallel_sort(lying);
  UnionFind same(ends.size());
  for (std::size_t i = 0, j; i < lying.size(); i = j) {
    const SeamEdge& one = borders[lying[i].index];
    const std::uint32_t a = number(one[0]), b = number(one[1]);
    for (j = i + 1; j < lying.size() && lying[j].key == lying[i].key; ++j) {
      const SeamEdge& other = borders[lying[j].index];
      std::uint32_t c = number(other[0]), d = number(other[1]);
      if (first[c] != first[a]) std::swap(c, d);
      same.join(a, c), same.join(b, d);
    }
  }
  // The vertex with the least index represents its set.
  for (std::uint32_t i = 0; i < ends.size(); ++i) result.joined += same.find(i) != i;
  if (result.joined > 0) {
    std::vector<std::uint32_t> name(mesh.vertices.size());
    std::iota(name.begin(), name.end(), 0u);
    for (std::uint32_t i = 0; i < ends.size(); ++i) name[ends[i]] = ends[same.find(i)];
    for (Triangle& t : sewn.triangles)
      for (std::uint32_t& v : t) v = name[v];
    std::erase_if(sewn.triangles, [](const Triangle& t) { return !has_distinct_corners(t); });
  }
  result.left_out = mesh.triangles.size() - sewn.triangles.size();
  return result;
}

MeshTopology sewn_topology(const SewnMesh& sewn) {
  MeshTopology topology = measure_topology(sewn.mesh);
  topology.unused_vertices -= std::min(topology.unused_vertices, sewn.joined);
  topology.degenerate_triangles += sewn.left_out;
  return topology;
}

MeshTopology sewn_topology(const TriangleMesh& mesh) { return sewn_topology(sewn_mesh(mesh)); }

}  // namespace sansmesh::inline v1
