// Cells of a grid in space: straight-edged polyhedra of four shapes, to which readers bring all others.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/api.h"

namespace sansmesh::inline v1 {

/// Corners in VTK's order: a tetrahedron's fourth lies on the side to which the first three turn left; a pyramid's base
/// is a ring, then the tip; a wedge is two triangles, corner k + 3 opposite of corner k; a hexahedron is two rings,
/// corner k + 4 opposite of corner k.
enum class CellShape : std::uint8_t { tetrahedron, pyramid, wedge, hexahedron };

inline constexpr std::size_t corner_count(CellShape shape) {
  constexpr std::size_t counts[] = {4, 5, 6, 8};
  return counts[static_cast<std::size_t>(shape)];
}

/// Edges of a cell as pairs of its corners.
SANSMESH_API std::span<const std::array<std::uint8_t, 2>> cell_edges(CellShape shape);

/// A face of a cell: `count` (3 or 4) of its corners in a ring, counter-clockwise seen from outside.
struct CellFace {
  std::uint8_t count;
  std::array<std::uint8_t, 4> corner;
};
SANSMESH_API std::span<const CellFace> cell_faces(CellShape shape);

/// Cells, one after the other. Degenerate ones (corners that coincide or repeat, no volume, inside out) may be there.
struct CellList {
  std::vector<CellShape> shapes;
  std::vector<std::uint32_t> corners;   ///< numbers of points, cell after cell
  std::vector<std::uint64_t> first{0};  ///< where in `corners` a cell begins; one more entry than cells

  std::size_t size() const { return shapes.size(); }
  bool empty() const { return shapes.empty(); }
  std::span<const std::uint32_t> operator[](std::size_t cell) const {
    return std::span(corners).subspan(first[cell], first[cell + 1] - first[cell]);
  }
  void add(CellShape shape, std::span<const std::uint32_t> points) {
    shapes.push_back(shape);
    corners.insert(corners.end(), points.begin(), points.end());
    first.push_back(corners.size());
  }
};

/// Lists of numbers, one for each row, in one array.
struct Adjacency {
  std::vector<std::uint32_t> entries;
  std::vector<std::uint64_t> first{0};  ///< one more entry than rows

  std::size_t size() const { return first.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t row) const {
    return std::span(entries).subspan(first[row], first[row + 1] - first[row]);
  }
};

}  // namespace sansmesh::inline v1
