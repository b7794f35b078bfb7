#include "sansmesh/volume/cells/cell_tetrahedra.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kFlatTetrahedron = 1e-14;  ///< volume over the cube of the longest edge

}  // namespace

void face_triangles(CellShape shape, std::span<const std::uint32_t> corners,
                    std::vector<std::array<std::uint8_t, 3>>& out) {
  for (const CellFace& face : cell_faces(shape)) {
    const auto& c = face.corner;
    if (face.count == 3) {
      out.push_back({c[0], c[1], c[2]});
      continue;
    }
    std::size_t least = 0;
    for (std::size_t k = 1; k < 4; ++k)
      if (corners[c[k]] < corners[c[least]]) least = k;
    const auto at = [&](std::size_t k) { return c[(least + k) % 4]; };
    out.push_back({at(0), at(1), at(2)});
    out.push_back({at(0), at(2), at(3)});
  }
}

void cell_tetrahedra(CellShape shape, std::span<const std::uint32_t> corners,
                     std::vector<std::array<std::uint32_t, 4>>& out) {
  if (shape == CellShape::tetrahedron) {
    out.push_back({corners[0], corners[1], corners[2], corners[3]});
    return;
  }
  static thread_local std::vector<std::array<std::uint8_t, 3>> triangles;
  triangles.clear();
  face_triangles(shape, corners, triangles);
  const auto least = static_cast<std::size_t>(std::min_element(corners.begin(), corners.end()) - corners.begin());
  for (const auto& t : triangles)
    if (t[0] != least && t[1] != least && t[2] != least)
      out.push_back({corners[t[0]], corners[t[2]], corners[t[1]], corners[least]});
}

TetrahedralVolume tetrahedra_of(const std::shared_ptr<const SampledVolume>& volume) {
  const CellList& cells = volume->cells;
  const auto is_tetrahedron = [](CellShape s) { return s == CellShape::tetrahedron; };
  if (std::all_of(cells.shapes.begin(), cells.shapes.end(), is_tetrahedron)) return {volume, {}};
  auto cut = std::make_shared<SampledVolume>();
  TetrahedralVolume result;
  cut->positions = volume->positions;
  std::vector<std::array<std::uint32_t, 4>> tetrahedra;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    tetrahedra.clear();
    cell_tetrahedra(cells.shapes[c], cells[c], tetrahedra);
    for (auto& t : tetrahedra) {
      const auto& p = volume->positions;
      const Vec3 x = p[t[1]] - p[t[0]], y = p[t[2]] - p[t[0]], z = p[t[3]] - p[t[0]];
      const double six = dot(cross(x, y), z);
      const double longest = std::max({squared_norm(x), squared_norm(y), squared_norm(z), squared_norm(y - x),
                                       squared_norm(z - x), squared_norm(z - y)});
      if (!(std::abs(six) > kFlatTetrahedron * longest * std::sqrt(longest))) continue;
      if (six < 0) std::swap(t[0], t[1]);  // in a badly warped cell
      cut->cells.add(CellShape::tetrahedron, t);
      result.cell_of.push_back(static_cast<std::uint32_t>(c));
    }
  }
  result.volume = std::move(cut);
  return result;
}

}  // namespace sansmesh::inline v1::detail
