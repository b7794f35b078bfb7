#include "sansmesh/mesh/mesh_size.h"

#include <cmath>

#include "sansmesh/core/boxes.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kSizeChunk = 16384;

}  // namespace

MeshSize measure_size(const TriangleMesh& mesh) {
  const Box3f box = finite_bounds(mesh.vertices);
  // Sums volumes relative to the centre, which minimises rounding errors.
  const Vec3 middle = box.empty() ? Vec3{} : Vec3(box.center());
  const std::size_t n = mesh.vertices.size();
  return parallel_reduce(
      mesh.triangles.size(), kSizeChunk, MeshSize{},
      [&](std::size_t first, std::size_t last) {
        MeshSize part;
        for (std::size_t i = first; i < last; ++i) {
          const Triangle& t = mesh.triangles[i];
          if (t[0] >= n || t[1] >= n || t[2] >= n) continue;
          const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
          const double area = triangle_area(a, b, c);
          if (!(area > 0) || !std::isfinite(area)) continue;
          part.area += area;
          part.volume += dot(a - middle, cross(b - a, c - a)) / 6;
        }
        return part;
      },
      [](const MeshSize& a, const MeshSize& b) {
        return MeshSize{a.area + b.area, a.volume + b.volume};
      });
}

}  // namespace sansmesh::inline v1
