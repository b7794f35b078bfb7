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

/// Shape functions of cells of higher order. Natural coordinates r, s, t: the unit simplex, prism and cube, and for
/// pyramids the base |r|, |s| <= 1/2, t = 0 with its tip at t = 1.
enum class HigherOrderFamily : std::uint8_t {
  tetrahedron,    ///< polynomials of degree n = orders[0]; nodes at (i, j, k) / n, i fastest
  wedge,          ///< polynomials of degree orders[0] in r and s, of degree orders[2] in t; nodes layer by layer
  hexahedron,     ///< products of polynomials of degrees orders[0], orders[1], orders[2]; nodes with i fastest
  hexahedron_20,  ///< quadratic serendipity functions; VTK's order of nodes, also below
  hexahedron_24,  ///< the same in r and s, times quadratic polynomials in t
  wedge_15,       ///< quadratic serendipity functions
  pyramid_13      ///< quadratic, with rational terms
};

/// Kind of a cell of higher order.
struct HigherOrderKind {
  HigherOrderFamily family = HigherOrderFamily::tetrahedron;  ///< its shape functions
  std::array<std::uint8_t, 3> orders{2, 2, 2};                ///< degrees, 1 to kMostOrder; 2 from hexahedron_20 on
  static constexpr std::uint8_t kMostOrder = 10;              ///< largest degree

  /// Equality of family and orders.
  bool operator==(const HigherOrderKind&) const = default;
};
/// Number of nodes of a cell of higher order; 0 if its orders are not allowed.
SANSMESH_API std::size_t node_count(const HigherOrderKind& kind);

/// Cells of higher order behind the cells of a list, which are pieces of them between their nodes.
struct HigherOrderCells {
  static constexpr std::uint32_t kNone = 0xffffffffu;  ///< no cell of higher order
  std::vector<std::uint32_t> of_piece;  ///< for each cell of the list its cell of higher order, or kNone; empty: none
  std::vector<HigherOrderKind> kinds;   ///< kind of each cell of higher order
  std::vector<std::uint32_t> nodes;     ///< point indices, cell by cell
  std::vector<std::uint64_t> first{0};  ///< start of each cell in `nodes`; one more entry than cells

  /// Number of cells of higher order.
  std::size_t size() const { return kinds.size(); }
  /// True if there are no cells of higher order.
  bool empty() const { return kinds.empty(); }
  /// Nodes of a cell. Valid until the list changes.
  std::span<const std::uint32_t> operator[](std::size_t cell) const {
    return std::span(nodes).subspan(first[cell], first[cell + 1] - first[cell]);
  }
  /// Appends a cell; `points` are its node_count(kind) nodes, which is not checked.
  void add(const HigherOrderKind& kind, std::span<const std::uint32_t> points) {
    kinds.push_back(kind);
    nodes.insert(nodes.end(), points.begin(), points.end());
    first.push_back(nodes.size());
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
