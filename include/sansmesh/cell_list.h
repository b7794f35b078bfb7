// Cells of a spatial grid: straight-edged polyhedra of four shapes. Readers convert all other shapes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/api.h"

namespace sansmesh::inline v1 {

/// Corners in VTK's order. Tetrahedron: the fourth corner is on the side from which the first three run
/// counter-clockwise. Pyramid: a ring of four, then the apex. Wedge: two triangles, corner k + 3 opposite corner k.
/// Hexahedron: two rings, corner k + 4 opposite corner k.
enum class CellShape : std::uint8_t { tetrahedron, pyramid, wedge, hexahedron };

/// Number of corners: 4, 5, 6 or 8.
inline constexpr std::size_t corner_count(CellShape shape) {
  constexpr std::size_t counts[] = {4, 5, 6, 8};
  return counts[static_cast<std::size_t>(shape)];
}

/// Edges of a cell as pairs of its corners (local numbers from 0).
SANSMESH_API std::span<const std::array<std::uint8_t, 2>> cell_edges(CellShape shape);

/// Face of a cell: a ring of `count` (3 or 4) corners, counter-clockwise seen from outside.
struct CellFace {
  std::uint8_t count = 0;                ///< number of corners, 3 or 4
  std::array<std::uint8_t, 4> corner{};  ///< local corner numbers; the first `count` are used
};
/// Faces of a cell.
SANSMESH_API std::span<const CellFace> cell_faces(CellShape shape);

/// List of cells. Degenerate cells (coincident or repeated corners, no volume, inverted) may occur.
struct CellList {
  std::vector<CellShape> shapes;        ///< shape of each cell
  std::vector<std::uint32_t> corners;   ///< point indices, cell by cell
  std::vector<std::uint64_t> first{0};  ///< start of each cell in `corners`; one more entry than cells

  /// Number of cells.
  std::size_t size() const { return shapes.size(); }
  /// Whether there are no cells.
  bool empty() const { return shapes.empty(); }
  /// Corners of a cell, in the order of CellShape. Valid until the list changes.
  std::span<const std::uint32_t> operator[](std::size_t cell) const {
    return std::span(corners).subspan(first[cell], first[cell + 1] - first[cell]);
  }
  /// Appends a cell; `points` are its corner_count(shape) corners, which is not checked.
  void add(CellShape shape, std::span<const std::uint32_t> points) {
    shapes.push_back(shape);
    corners.insert(corners.end(), points.begin(), points.end());
    first.push_back(corners.size());
  }
};

/// Lists of numbers, one per row, in one array (compressed sparse rows). `Offset` counts the entries.
template <class Offset>
struct AdjacencyT {
  std::vector<std::uint32_t> entries;  ///< entries of all rows, row by row
  std::vector<Offset> first{0};        ///< start of each row in `entries`; one more entry than rows

  /// Number of rows.
  std::size_t size() const { return first.size() - 1; }
  /// Entries of a row. Valid until the lists change.
  std::span<const std::uint32_t> operator[](std::size_t row) const {
    return std::span(entries).subspan(first[row], first[row + 1] - first[row]);
  }
};

/// Lists of any length.
using Adjacency = AdjacencyT<std::uint64_t>;

}  // namespace sansmesh::inline v1
