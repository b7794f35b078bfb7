#include "sansmesh/mesh/repair/weld.h"

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/data/triangles.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/points/cleaning/close_points.h"

namespace sansmesh::inline v1 {
namespace {

/// Averages normals and colours; `group` maps old to new vertices.
void mix_directions_and_colors(TriangleMesh& mesh, const std::vector<std::uint32_t>& group, std::size_t groups) {
  if (!mesh.normals.empty()) {
    std::vector<Vec3> sums(groups);
    std::vector<std::uint32_t> counts(groups);
    for (std::size_t v = 0; v < group.size(); ++v) sums[group[v]] += Vec3(mesh.normals[v]), ++counts[group[v]];
    mesh.normals.resize(groups);
    for (std::size_t g = 0; g < groups; ++g) {
      if (counts[g] == 1)
        mesh.normals[g] = Vec3f(sums[g]);  // bit-identical
      else                                 // directions that cancel up to rounding give zero
        mesh.normals[g] = norm(sums[g]) > 1e-3 ? Vec3f(normalized(sums[g])) : Vec3f{};
    }
  }
  if (!mesh.colors.empty()) {
    std::vector<std::array<std::uint32_t, 4>> sums(groups);
    for (std::size_t v = 0; v < group.size(); ++v) {
      auto& sum = sums[group[v]];
      for (std::size_t k = 0; k < 3; ++k) sum[k] += mesh.colors[v][k];
      ++sum[3];
    }
    mesh.colors.resize(groups);
    for (std::size_t g = 0; g < groups; ++g)
      for (std::size_t k = 0; k < 3; ++k)
        mesh.colors[g][k] = static_cast<std::uint8_t>((sums[g][k] + sums[g][3] / 2) / sums[g][3]);
  }
}

}  // namespace

WeldReport weld_vertices(TriangleMesh& mesh, double distance) {
  const std::size_t n = mesh.vertices.size();
  const std::vector<std::uint32_t> first = close_representatives(mesh.vertices, distance);
  std::vector<std::uint32_t> group(n);
  std::vector<std::uint32_t> kept;
  for (std::uint32_t v = 0; v < n; ++v) {
    if (first[v] == v) {
      group[v] = static_cast<std::uint32_t>(kept.size());
      kept.push_back(v);
    } else {
      group[v] = group[first[v]];  // an earlier vertex
    }
  }
  WeldReport report;
  report.vertices = n - kept.size();
  if (report.vertices == 0) return report;
  const std::size_t before = measure_topology(mesh).nonmanifold_edges;
  if (!mesh.attributes.empty()) {
    const std::vector<double> weight(n, 1);
    mesh.attributes = mesh.attributes.means(group, weight, kept.size());
  }
  mix_directions_and_colors(mesh, group, kept.size());
  for (std::size_t g = 0; g < kept.size(); ++g) mesh.vertices[g] = mesh.vertices[kept[g]];
  mesh.vertices.resize(kept.size());
  std::vector<std::uint32_t> left;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& old = mesh.triangles[i];
    const Triangle t{group[old[0]], group[old[1]], group[old[2]]};
    if (!has_distinct_corners(t)) continue;
    mesh.triangles[left.size()] = t;
    left.push_back(static_cast<std::uint32_t>(i));
  }
  report.triangles = mesh.triangles.size() - left.size();
  if (report.triangles > 0 && !mesh.triangle_attributes.empty())
    mesh.triangle_attributes = mesh.triangle_attributes.taken(left);
  mesh.triangles.resize(left.size());
  const std::size_t after = measure_topology(mesh).nonmanifold_edges;
  report.nonmanifold_edges = after > before ? after - before : 0;
  return report;
}

}  // namespace sansmesh::inline v1
