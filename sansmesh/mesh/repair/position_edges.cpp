#include "sansmesh/mesh/repair/position_edges.h"
#include "sansmesh/core/edge_key.h"

#include "sansmesh/core/parallel.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_vertices.h"

#include "sansmesh/mesh/vertex_corners.h"
#include "sansmesh/search/equal_positions.h"

namespace sansmesh::inline v1 {

PositionEdges edges_by_position(const TriangleMesh& mesh) {
  if (mesh.triangles.size() > kMostTriangles) throw DataError("the mesh has more triangles than can be counted");
  PositionEdges all;
  all.representative = first_equal_positions(mesh.vertices);
  std::vector<KeyIndex> keys;
  keys.reserve(3 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!has_valid_corners(mesh.vertices, mesh.triangles[i])) continue;
    Triangle t = mesh.triangles[i];
    for (std::uint32_t& v : t) v = all.representative[v];
    if (!has_distinct_corners(t)) continue;
    for (std::size_t k = 0; k < 3; ++k)
      keys.push_back({edge_key(t[k], t[(k + 1) % 3]), static_cast<unsigned>(3 * i + k)});
  }
  parallel_sort(keys);
  all.corners.resize(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    all.corners[i] = keys[i].index;
    if (i == 0 || keys[i].key != keys[i - 1].key)
      all.edges.push_back({static_cast<std::uint32_t>(keys[i].key >> 32), static_cast<std::uint32_t>(keys[i].key),
                           static_cast<std::uint32_t>(i), 0});
    ++all.edges.back().count;
  }
  return all;
}

namespace {

bool looks_the_same(const TriangleMesh& mesh, std::size_t a, std::size_t b) {
  if (!mesh.colors.empty() && mesh.colors[a] != mesh.colors[b]) return false;
  for (const Attribute& one : mesh.attributes)
    for (std::size_t k = 0; k < one.components; ++k) {
      const double p = one.number(a * one.components + k), q = one.number(b * one.components + k);
      if (p != q && (p == p || q == q)) return false;
    }
  return true;
}

}  // namespace

JoinedVertices join_equal_vertices(TriangleMesh& mesh) {
  JoinedVertices report;
  const std::vector<std::uint32_t> first = first_equal_positions(mesh.vertices);
  std::vector<std::uint32_t> number(mesh.vertices.size()), kept;
  std::vector<Vec3> normals(mesh.normals.size());
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    const bool joins = first[v] != v && looks_the_same(mesh, first[v], v);
    if (joins) {
      number[v] = number[first[v]];
      ++report.joined;
    } else {
      report.seams += first[v] != v;
      number[v] = static_cast<std::uint32_t>(kept.size());
      kept.push_back(v);
    }
    if (!normals.empty()) normals[kept[number[v]]] += Vec3(mesh.normals[v]);
  }
  if (report.joined == 0) return report;
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t)
      if (v < number.size()) v = number[v];
  for (std::size_t v = 0; v < normals.size(); ++v) mesh.normals[v] = Vec3f(normalized(normals[v]));
  take_vertices(mesh, kept);
  return report;
}

}  // namespace sansmesh::inline v1
