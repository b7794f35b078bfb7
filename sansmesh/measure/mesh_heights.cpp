#include "sansmesh/measure/mesh_heights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kMostMeshHeights = 1e9;

/// Raises the cells whose centres are under a triangle. Corners in cells, y to the south.
void raise_to_triangle(PixelMap<float>& heights, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const double twice = ab.x * ac.y - ab.y * ac.x;
  if (twice == 0) return;
  const double top = std::min({a.y, b.y, c.y}), bottom = std::max({a.y, b.y, c.y});
  const double left = std::min({a.x, b.x, c.x}), right = std::max({a.x, b.x, c.x});
  // A centre on a common edge of two triangles is under both.
  constexpr double kOnEdge = -1e-9;
  for (int r = index_in<int>(std::ceil(top - 0.5), 0, heights.height); r < heights.height && r + 0.5 <= bottom; ++r)
    for (int k = index_in<int>(std::ceil(left - 0.5), 0, heights.width); k < heights.width && k + 0.5 <= right; ++k) {
      const double x = k + 0.5 - a.x, y = r + 0.5 - a.y;
      const double u = (x * ac.y - y * ac.x) / twice, v = (ab.x * y - ab.y * x) / twice;
      if (u < kOnEdge || v < kOnEdge || u + v > 1 - kOnEdge) continue;
      const auto h = static_cast<float>(a.z + u * ab.z + v * ac.z);
      float& to = heights.at(k, r);
      if (!(to >= h)) to = h;
    }
}

}  // namespace

HeightGrid make_mesh_heights(const TriangleMesh& mesh, double cell, Progress& progress) {
  progress.begin("heights");
  const Box3f box = bounds(mesh);
  if (box.empty() || mesh.triangles.empty()) throw DataError("the mesh is empty");
  const auto below = [&](double x) { return std::floor(x / cell); };
  const double left = below(mesh.origin.x + static_cast<double>(box.lower.x));
  const double right = below(mesh.origin.x + static_cast<double>(box.upper.x)) + 1;
  const double bottom = below(mesh.origin.y + static_cast<double>(box.lower.y));
  const double top = below(mesh.origin.y + static_cast<double>(box.upper.y)) + 1;
  if (!((right - left) * (top - bottom) <= kMostMeshHeights))
    throw DataError("there would be " + grouped(whole_part<std::size_t>((right - left) * (top - bottom))) +
                    " cells: at most 1,000,000,000 are possible");
  HeightGrid grid{
      {static_cast<int>(right - left), static_cast<int>(top - bottom), std::numeric_limits<float>::quiet_NaN()},
      cell,
      left * cell,
      top * cell,
      mesh.reference};
  const auto corner = [&](std::uint32_t v) {
    const Vec3 p(mesh.vertices[v]);
    return Vec3{(mesh.origin.x + p.x - grid.left) / cell, (grid.top - mesh.origin.y - p.y) / cell, mesh.origin.z + p.z};
  };
  for (const auto& t : mesh.triangles) raise_to_triangle(grid.heights, corner(t[0]), corner(t[1]), corner(t[2]));
  return grid;
}

}  // namespace sansmesh::inline v1
