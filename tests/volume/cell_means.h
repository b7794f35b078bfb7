// Exact means of functions over the cells of synthetic grids.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "sansmesh/volume/cells/cell_geometry.h"
#include "volume/volume_grids.h"

namespace sansmesh::test {

/// Mean over a cell by Gauss's rule of four points in `parts`³ parts of its parameters.
inline double cell_mean(CellShape shape, std::span<const Vec3> corners, const VolumeFunction& f, int parts) {
  const double near = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2)) / 2,
               far = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2)) / 2;
  const double at[] = {0.5 - far, 0.5 - near, 0.5 + near, 0.5 + far};
  const double outer = (18 - std::sqrt(30.0)) / 72, inner = (18 + std::sqrt(30.0)) / 72;
  const double weight[] = {outer, inner, inner, outer};
  const CellMap map(shape, corners);
  double sum = 0, volume = 0;
  const int n = 4 * parts;
  const auto node = [&](int i) {
    const int part = i / 4;
    return (part + at[i % 4]) / parts;
  };
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        Vec3 u{node(i), node(j), node(k)};
        double w = weight[i % 4] * weight[j % 4] * weight[k % 4];
        if (shape == CellShape::wedge || shape == CellShape::tetrahedron) w *= 1 - u.x, u.y *= 1 - u.x;
        if (shape == CellShape::tetrahedron) w *= 1 - u.x - u.y, u.z *= 1 - u.x - u.y;
        const auto d = map.derivatives(u);
        w *= std::abs(dot(d[0], cross(d[1], d[2])));
        sum += w * f(map.at(u)), volume += w;
      }
  return sum / volume;
}

/// Sets the cell arrays "f" to means. `parts(x, size)`: parts per direction of a cell at x with that diagonal.
inline void set_means(
    GridData& data, const VolumeFunction& f,
    const std::function<int(const Vec3&, double)>& parts = [](const Vec3&, double) { return 1; }) {
  for (GridBlock& block : data.blocks) {
    const CellList cells = block_cells(block);
    std::vector<double> means;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      std::vector<Vec3> corners;
      Vec3 middle;
      for (const std::uint32_t p : cells[c]) corners.push_back(block_point(block, p)), middle += corners.back();
      middle = middle / static_cast<double>(corners.size());
      double size = 0;
      for (const Vec3& x : corners) size = std::max(size, 2 * norm(x - middle));
      means.push_back(cell_mean(cells.shapes[c], corners, f, parts(middle, size)));
    }
    block.cell_arrays.set("f", std::move(means));
  }
}

/// A front of half its width w on a sphere: ½ (1 − tanh(s / w)) with the signed distance s.
struct SphereFront {
  Vec3 center{0.52, 0.49, 0.505};
  double radius = 0.29, width = 0.01;

  double distance(const Vec3& x) const { return norm(x - center) - radius; }
  double operator()(const Vec3& x) const { return 0.5 * (1 - std::tanh(distance(x) / width)); }
};

/// Sets means of a front, with at most three of its widths along each edge of a part.
inline void set_front_means(GridData& data, const SphereFront& front) {
  set_means(data, front, [&](const Vec3& x, double size) {
    if (std::abs(front.distance(x)) > 0.5 * size + 4 * front.width) return 1;
    return std::clamp(static_cast<int>(std::ceil(size / (5 * front.width))), 1, 6);
  });
}

}  // namespace sansmesh::test
