// Pieces of VTK's cells of higher order between their nodes, and the nodes in this library's order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::io {

/// Collects linear cells, and the cells of higher order that they are pieces of.
class CellPieces {
 public:
  /// Positions of the nodes; must outlive this.
  explicit CellPieces(std::span<const Vec3> points) : points_(points) {}

  CellList cells;
  HigherOrderCells higher;          ///< `of_piece` ends with the last piece
  std::vector<std::uint32_t> rows;  ///< for each cell: its row in the file

 protected:
  void piece(CellShape shape, std::initializer_list<std::uint32_t> nodes);
  /// Tetrahedra between the first node and the faces that do not have it, rings in outside view.
  void cone(std::span<const std::vector<std::uint32_t>> faces);
  /// The cell of higher order of the pieces that follow.
  void keep(HigherOrderFamily family, std::array<std::size_t, 3> orders, std::vector<std::uint32_t> nodes);

  void add_tetrahedron_10(std::span<const std::uint32_t> nodes);
  void add_hexahedron_24(std::span<const std::uint32_t> nodes);
  void add_hexahedron_27(std::span<const std::uint32_t> nodes);
  void add_wedge(std::span<const std::uint32_t> nodes);
  /// These return false if the number of nodes fits no order. `degrees`: see LinearCells.
  bool add_lagrange_hexahedron(std::span<const std::uint32_t> nodes, const std::array<int, 3>& degrees);
  bool add_lagrange_tetrahedron(std::span<const std::uint32_t> nodes);
  bool add_lagrange_wedge(std::span<const std::uint32_t> nodes, const std::array<int, 3>& degrees);

  std::uint32_t row_ = 0;

 private:
  bool comes_first(std::uint32_t a, std::uint32_t b) const;
  /// Pieces between the nodes at(i, j, k), n[0] n[1] n[2] hexahedra, n³ tetrahedra (and more) or n² m wedges; keeps the
  /// nodes as a cell of higher order.
  template <class At>
  void lattice(std::array<std::size_t, 3> n, const At& at);
  template <class At>
  void simplex(std::size_t n, const At& at);
  template <class At>
  void prism(std::size_t n, std::size_t layers, const At& at);
  void octahedron(const std::array<std::uint32_t, 6>& nodes);

  std::span<const Vec3> points_;
};

}  // namespace sansmesh::inline v1::io
