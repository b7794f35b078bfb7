// Converts cells of all of VTK's types to this library's cells: straight-edged polyhedra of four shapes, and flat
// cells.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::io {

/// Collects cells and cuts them if needed. Cells with nodes on their edges are cut at all of these nodes. (Nodes at
/// corners of quadratic pyramids in faces, and nodes of orders higher than those of Lagrange hexahedra and
/// quadrilaterals, are ignored.) Polyhedra become tetrahedra that share the first node (by x, then y, then z, then
/// number), and their faces triangles that share theirs. So cells with a common face are cut alike there, whatever the
/// order of the nodes. Cells keep VTK's orientation; inverted cells stay inverted.
class LinearCells {
 public:
  /// Positions of the nodes; must outlive this.
  explicit LinearCells(std::span<const Vec3> points) : points_(points) {}

  /// `type` is VTK's number of a linear, quadratic or Lagrange cell; nodes are in VTK's order. Returns false if there
  /// are fewer nodes than the type has.
  bool add(int type, std::span<const std::uint32_t> nodes, std::uint32_t row);
  /// A polyhedron by its faces, each a ring of nodes.
  void add_polyhedron(std::span<const std::vector<std::uint32_t>> faces, std::uint32_t row);
  /// Tetrahedra of a cell cut elsewhere, four nodes each.
  void add_tetrahedra(std::span<const std::uint32_t> nodes, std::uint32_t row);
  void leave_out(const std::string& kind) { ++left_out_[kind]; }

  /// Notes on cells that were cut or skipped and on ignored nodes.
  std::vector<std::string> notes() const;

  CellList cells;
  std::vector<std::uint32_t> rows;                       ///< for each cell: its `row`
  std::vector<std::array<std::uint32_t, 4>> flat_cells;  ///< as in GridBlock
  std::vector<std::uint32_t> flat_rows;
  std::size_t lines = 0, vertices = 0;  ///< skipped

 private:
  bool comes_first(std::uint32_t a, std::uint32_t b) const;
  void piece(CellShape shape, std::initializer_list<std::uint32_t> nodes);
  void flat(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
  void fan(std::span<const std::uint32_t> ring);
  void cone(std::span<const std::vector<std::uint32_t>> faces);
  bool add_quadratic(CellShape shape, std::span<const std::uint32_t> nodes);
  /// n³ hexahedra between the nodes at(i, j, k).
  template <class At>
  void lattice(std::size_t n, const At& at);
  bool add_solid(int type, std::span<const std::uint32_t> nodes);
  bool add_higher_order(int type, std::span<const std::uint32_t> nodes);
  bool add_flat(int type, std::span<const std::uint32_t> nodes);

  std::span<const Vec3> points_;
  std::uint32_t row_ = 0;
  std::map<std::string, std::array<std::size_t, 2>> cut_;  ///< by kind: cells, and pieces made of them
  std::map<std::string, std::size_t> left_out_, corners_only_;
};

}  // namespace sansmesh::inline v1::io
