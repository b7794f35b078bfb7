// Slow reference checks of a mesh.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::test {

struct Topology {
  std::size_t bad_edges = 0;     ///< not shared by exactly two triangles of opposite direction
  std::size_t bad_vertices = 0;  ///< triangles do not form one closed fan
  long euler = 0;
  bool closed_manifold() const { return bad_edges == 0 && bad_vertices == 0; }
};

inline Topology topology_of(const TriangleMesh& mesh) {
  Topology result;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::vector<std::vector<Triangle>> around(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      ++edges[{t[k], t[(k + 1) % 3]}];
      around[t[k]].push_back({t[k], t[(k + 1) % 3], t[(k + 2) % 3]});
    }
  for (const auto& [edge, count] : edges) {
    const auto twin = edges.find({edge.second, edge.first});
    if (count != 1 || twin == edges.end() || twin->second != 1) ++result.bad_edges;
  }
  std::size_t used = 0;
  for (const auto& fan : around) {
    if (fan.empty()) continue;
    ++used;
    std::map<std::uint32_t, std::uint32_t> next;
    for (const Triangle& t : fan) next[t[1]] = t[2];
    std::set<std::uint32_t> seen;
    for (std::uint32_t at = fan[0][1]; seen.insert(at).second && next.count(at);) at = next[at];
    if (seen.size() != fan.size() || next.size() != fan.size()) ++result.bad_vertices;
  }
  result.euler =
      static_cast<long>(used) - static_cast<long>(edges.size()) / 2 + static_cast<long>(mesh.triangles.size());
  return result;
}

}  // namespace sansmesh::test
