// Synthetic grids of every kind for tests of volumes. Each has an array "f" with one component from a given function,
// on points and on cells (at the mean of a cell's corners).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/grid_data.h"

namespace sansmesh::test {

using VolumeFunction = std::function<double(const Vec3&)>;

/// a + b·x with coefficients without symmetry.
inline double linear_function(const Vec3& x) { return 0.75 + 1.5 * x.x - 0.625 * x.y + 2.25 * x.z; }
inline constexpr Vec3 kLinearGradient{1.5, -0.625, 2.25};

inline Vec3 block_point(const GridBlock& block, std::size_t i) {
  if (block.kind != GridKind::lattice) return block.points[i];
  const std::size_t nx = block.axes[0].size(), ny = block.axes[1].size();
  return block.origin + block.directions[0] * block.axes[0][i % nx] + block.directions[1] * block.axes[1][i / nx % ny] +
         block.directions[2] * block.axes[2][i / (nx * ny)];
}

inline std::array<std::size_t, 3> block_dims(const GridBlock& block) {
  if (block.kind != GridKind::lattice) return block.dims;
  return {block.axes[0].size(), block.axes[1].size(), block.axes[2].size()};
}

inline std::size_t block_point_count(const GridBlock& block) {
  const auto n = block_dims(block);
  return block.kind == GridKind::lattice ? n[0] * n[1] * n[2] : block.points.size();
}

/// The cells of a structured block in the order of the block; other blocks' own cells.
inline CellList block_cells(const GridBlock& block) {
  if (block.kind == GridKind::unstructured || block.kind == GridKind::scattered) return block.cells;
  const auto n = block_dims(block);
  const auto at = [&](std::size_t i, std::size_t j, std::size_t k) {
    return static_cast<std::uint32_t>(i + n[0] * (j + n[1] * k));
  };
  CellList cells;
  for (std::size_t k = 0; k + 1 < n[2]; ++k)
    for (std::size_t j = 0; j + 1 < n[1]; ++j)
      for (std::size_t i = 0; i + 1 < n[0]; ++i)
        cells.add(CellShape::hexahedron,
                  std::array{at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k), at(i, j, k + 1),
                             at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)});
  return cells;
}

/// Sets the arrays "f" of a block.
inline void set_function(GridBlock& block, const VolumeFunction& f) {
  std::vector<double> of_points(block_point_count(block));
  for (std::size_t i = 0; i < of_points.size(); ++i) of_points[i] = f(block_point(block, i));
  block.point_arrays.set("f", std::move(of_points));
  const CellList cells = block_cells(block);
  if (cells.empty()) return;
  std::vector<double> of_cells;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    Vec3 sum;
    for (const std::uint32_t p : cells[c]) sum += block_point(block, p);
    of_cells.push_back(f(sum / static_cast<double>(cells[c].size())));
  }
  block.cell_arrays.set("f", std::move(of_cells));
}

inline GridData one_block(GridBlock block, const VolumeFunction& f) {
  set_function(block, f);
  GridData data;
  data.blocks.push_back(std::move(block));
  return data;
}

/// n numbers from `from` to `to`; each step is `growth` times the previous one.
inline std::vector<double> axis_steps(std::size_t n, double from, double to, double growth = 1) {
  std::vector<double> axis(n);
  double step = 1, at = 0;
  for (double& a : axis) a = at, at += step, step *= growth;
  const double last = axis.back();
  for (double& a : axis) a = n > 1 ? from + (to - from) * (a / last) : from;
  return axis;
}

inline GridBlock lattice_block(std::array<std::size_t, 3> n, const Vec3& from = {0, 0, 0}, const Vec3& to = {1, 1, 1},
                               double growth = 1) {
  GridBlock block;
  block.kind = GridKind::lattice;
  for (std::size_t k = 0; k < 3; ++k) block.axes[k] = axis_steps(n[k], from[k], to[k], growth);
  return block;
}

inline GridData lattice_grid(std::array<std::size_t, 3> n, const VolumeFunction& f) {
  return one_block(lattice_block(n), f);
}

/// A rectilinear grid with steps that grow by a factor.
inline GridData stretched_grid(std::array<std::size_t, 3> n, const VolumeFunction& f, double growth = 1.3) {
  return one_block(lattice_block(n, {0, 0, 0}, {1, 1, 1}, growth), f);
}

/// The same points as a curvilinear block, moved by a map.
inline GridBlock curvilinear_block(const GridBlock& lattice, const std::function<Vec3(const Vec3&)>& map) {
  GridBlock block;
  block.kind = GridKind::curvilinear;
  block.dims = block_dims(lattice);
  for (std::size_t i = 0; i < block_point_count(lattice); ++i) block.points.push_back(map(block_point(lattice, i)));
  return block;
}

/// A bent and twisted cube without planar faces.
inline Vec3 bend(const Vec3& x) {
  return {x.x + 0.15 * std::sin(2.5 * x.y + x.z), x.y + 0.12 * std::cos(3 * x.x - x.z), x.z + 0.1 * x.x * x.y};
}

inline GridData bent_grid(std::array<std::size_t, 3> n, const VolumeFunction& f, double growth = 1) {
  return one_block(curvilinear_block(lattice_block(n, {0, 0, 0}, {1, 1, 1}, growth), bend), f);
}

/// A cylinder around the z axis, radius 1, height 2, with axes angle, radius, height. The first radius is 0, so that a
/// plane of points collapses to the axis, and the last angle equals the first up to rounding. Radii grow by `growth`.
inline GridBlock o_grid_block(std::array<std::size_t, 3> n, double growth = 1.15) {
  GridBlock block = lattice_block(n, {0, 0, 0}, {2 * std::numbers::pi, 1, 2});
  block.axes[1] = axis_steps(n[1], 0, 1, growth);
  return curvilinear_block(block, [](const Vec3& x) { return Vec3{x.y * std::cos(x.x), x.y * std::sin(x.x), x.z}; });
}

inline GridData o_grid(std::array<std::size_t, 3> n, const VolumeFunction& f) { return one_block(o_grid_block(n), f); }

/// Each hexahedron of a structured block split into six conforming tetrahedra around its diagonal from corner 0 to 6.
inline GridBlock tetrahedra_of(const GridBlock& structured) {
  GridBlock block;
  block.kind = GridKind::unstructured;
  for (std::size_t i = 0; i < block_point_count(structured); ++i) block.points.push_back(block_point(structured, i));
  const CellList hexes = block_cells(structured);
  constexpr int kAround[] = {1, 2, 3, 7, 4, 5, 1};
  for (std::size_t c = 0; c < hexes.size(); ++c)
    for (int t = 0; t < 6; ++t)
      block.cells.add(CellShape::tetrahedron,
                      std::array{hexes[c][0], hexes[c][static_cast<std::size_t>(kAround[t])],
                                 hexes[c][static_cast<std::size_t>(kAround[t + 1])], hexes[c][6]});
  return block;
}

inline GridData tetrahedra_grid(std::array<std::size_t, 3> n, const VolumeFunction& f) {
  return one_block(tetrahedra_of(lattice_block(n)), f);
}

/// Hexahedra that a reader has cut into six tetrahedra each. The value of a cell is that at its centre.
inline GridData cut_grid(std::array<std::size_t, 3> n, const VolumeFunction& f) {
  const GridBlock whole = lattice_block(n);
  GridData data = one_block(tetrahedra_of(whole), f);
  GridBlock& block = data.blocks[0];
  const CellList hexes = block_cells(whole);
  std::vector<double> values;
  for (std::size_t c = 0; c < block.cells.size(); ++c) {
    block.piece_of.push_back(static_cast<std::uint32_t>(c / 6));
    Vec3 sum;
    for (const std::uint32_t p : hexes[c / 6]) sum += block.points[p];
    values.push_back(f(sum / 8.0));
  }
  block.cell_arrays.set("f", std::move(values));
  return data;
}

/// Hexahedra, wedges and pyramids side by side: every third hexahedron along x is split into two wedges (with whole
/// common faces along y), every third into six pyramids around its centre.
inline GridData mixed_grid(std::array<std::size_t, 3> n, const VolumeFunction& f) {
  const GridBlock lattice = lattice_block(n);
  GridBlock block;
  block.kind = GridKind::unstructured;
  for (std::size_t i = 0; i < block_point_count(lattice); ++i) block.points.push_back(block_point(lattice, i));
  const CellList hexes = block_cells(lattice);
  for (std::size_t c = 0; c < hexes.size(); ++c) {
    const auto h = hexes[c];
    switch (c % (n[0] - 1) % 3) {
      case 0:
        block.cells.add(CellShape::hexahedron, h);
        break;
      case 1:  // split along the diagonals of the faces across z, equally within a column
        block.cells.add(CellShape::wedge, std::array{h[0], h[2], h[1], h[4], h[6], h[5]});
        block.cells.add(CellShape::wedge, std::array{h[0], h[3], h[2], h[4], h[7], h[6]});
        break;
      default: {
        Vec3 middle;
        for (const std::uint32_t p : h) middle += block.points[p] / 8;
        const auto tip = static_cast<std::uint32_t>(block.points.size());
        block.points.push_back(middle);
        for (const CellFace& face : cell_faces(CellShape::hexahedron))  // inward seen from the tip
          block.cells.add(CellShape::pyramid,
                          std::array{h[face.corner[0]], h[face.corner[3]], h[face.corner[2]], h[face.corner[1]], tip});
      }
    }
  }
  return one_block(std::move(block), f);
}

/// Uniform in the unit cube, with its eight corners, so that its hull is the cube.
inline GridData scattered_grid(std::size_t count, const VolumeFunction& f, unsigned seed = 7) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  GridBlock block;
  block.kind = GridKind::scattered;
  for (int c = 0; c < 8; ++c)
    block.points.push_back({static_cast<double>(c & 1), static_cast<double>(c >> 1 & 1), static_cast<double>(c >> 2)});
  while (block.points.size() < count) {
    const double x = uniform(), y = uniform(), z = uniform();
    block.points.push_back({x, y, z});
  }
  return one_block(std::move(block), f);
}

/// Two levels: the unit cube in n³ cells, and its part [¼, ¾]³ in cells half as large (n a multiple of 4). The coarse
/// cells below are hidden if `blanked`, as in some files.
inline GridData two_level_amr(std::size_t n, const VolumeFunction& f, bool blanked = true) {
  GridBlock coarse = lattice_block({n + 1, n + 1, n + 1});
  GridBlock fine = lattice_block({n + 1, n + 1, n + 1}, {0.25, 0.25, 0.25}, {0.75, 0.75, 0.75});
  coarse.name = "coarse", fine.name = "fine";
  fine.level = 1;
  if (blanked)
    for (std::size_t c = 0; c < n * n * n; ++c) {
      const auto covered = [&](std::size_t i) { return i >= n / 4 && i < n - n / 4; };
      coarse.hidden_cells.push_back(covered(c % n) && covered(c / n % n) && covered(c / (n * n)));
    }
  set_function(coarse, f);
  set_function(fine, f);
  GridData data;
  data.blocks = {std::move(coarse), std::move(fine)};
  return data;
}

/// Three overlapping curvilinear blocks with spacings of about 1/n, 1/(1.7 n) and 1/(2.6 n): a box, a rotated one and a
/// bent one. Their union is not convex.
inline GridData three_overlapping_blocks(std::size_t n, const VolumeFunction& f) {
  const auto m = static_cast<std::size_t>(1.7 * static_cast<double>(n) * 0.8),
             l = static_cast<std::size_t>(2.6 * static_cast<double>(n) * 0.5);
  GridData data;
  data.blocks.push_back(curvilinear_block(lattice_block({n + 1, n + 1, n + 1}), [](const Vec3& x) { return x; }));
  data.blocks.push_back(curvilinear_block(lattice_block({m + 1, m + 1, m + 1}), [](const Vec3& x) {
    const double c = std::cos(0.5), s = std::sin(0.5);
    const Vec3 d = (x - Vec3{0.5, 0.5, 0.5}) * 0.8;
    return Vec3{0.9 + c * d.x - s * d.y, 0.5 + s * d.x + c * d.y, 0.5 + d.z};
  }));
  data.blocks.push_back(curvilinear_block(lattice_block({l + 1, l + 1, l + 1}), [](const Vec3& x) {
    return bend(x * 0.5) + Vec3{0.2, 0.2, 0.2};
  }));
  for (GridBlock& block : data.blocks) set_function(block, f);
  return data;
}

/// Two adjacent boxes with the same points in the plane x = 1 (n each way), or with n and m points.
inline GridData abutting_blocks(std::size_t n, std::size_t m, const VolumeFunction& f) {
  GridData data;
  data.blocks.push_back(
      curvilinear_block(lattice_block({n, n, n}, {0, 0, 0}, {1, 1, 1}), [](const Vec3& x) { return x; }));
  data.blocks.push_back(
      curvilinear_block(lattice_block({m, m, m}, {1, 0, 0}, {2, 1, 1}), [](const Vec3& x) { return x; }));
  for (GridBlock& block : data.blocks) set_function(block, f);
  return data;
}

}  // namespace sansmesh::test
