#include "sansmesh/mesh/edit/mesh_noise.h"

#include <cmath>
#include <vector>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/data/triangles.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Ratio of the median of the second differences to the standard deviation of independent noise, for six neighbours.
constexpr double kMedianOverNoise = 1.36 * 0.6745;

}  // namespace

double noise_in_edges(std::span<const Vec3> x, std::span<const Triangle> triangles,
                      std::span<const std::uint32_t> first, std::span<const std::uint32_t> neighbour) {
  std::vector<Vec3> normal(x.size());
  for (const Triangle& t : triangles) {
    const Vec3 doubled = cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]]);
    for (const std::uint32_t v : t) normal[v] += doubled;
  }
  std::vector<double> difference(x.size(), 0), length(x.size(), 0);
  parallel_for(0, x.size(), 4096, [&](std::size_t v) {
    const double count = first[v + 1] - first[v];
    Vec3 sum;
    for (std::uint32_t k = first[v]; k < first[v + 1]; ++k) {
      sum += x[neighbour[k]] - x[v];
      length[v] += norm(x[neighbour[k]] - x[v]) / count;
    }
    if (count > 0) difference[v] = dot(normalized(normal[v]), sum / count);
  });
  std::vector<double> found;
  for (std::size_t v = 0; v < x.size(); ++v) {
    const double count = first[v + 1] - first[v];
    if (!(length[v] > 0)) continue;
    double twice = difference[v];
    for (std::uint32_t k = first[v]; k < first[v + 1]; ++k) twice -= difference[neighbour[k]] / count;
    found.push_back(std::abs(twice) / length[v]);
  }
  return found.empty() ? 0 : median(found) / kMedianOverNoise;
}

void renew_normals(TriangleMesh& mesh) {
  std::vector<Vec3> sum(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    if (!has_valid_corners(mesh.vertices, t)) continue;
    const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    const Vec3 doubled = cross(b - a, c - a);
    for (const std::uint32_t v : t) sum[v] += doubled;
  }
  for (std::size_t v = 0; v < sum.size(); ++v)
    if (squared_norm(sum[v]) > 0) mesh.normals[v] = Vec3f(normalized(sum[v]));
}

}  // namespace sansmesh::inline v1::detail
