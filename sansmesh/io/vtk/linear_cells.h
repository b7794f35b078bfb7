// Cells of all of VTK's types as those that this library has: straight-edged polyhedra of four shapes, and flat ones.
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

/// Takes cells one by one, cut where that is needed. Cells with nodes on their edges are cut at all of them (up to
/// corners of quadratic pyramids in faces, and nodes of higher order than Lagrange hexahedra and quadrilaterals have,
/// which are left aside); polyhedra into tetrahedra that share the first node (by x, then y, then z, then its number),
/// their faces into triangles that do, so that cells that share a face are cut alike there, whatever the order of the
/// nodes. Cells keep VTK's orientation; those that are inside out stay so.
class LinearCells {
 public:
  /// Where the nodes are; must outlive it.
  explicit LinearCells(std::span<const Vec3> places) : places_(places) {}

  /// `type` is one of VTK's numbers of linear, quadratic and Lagrange cells; nodes are in its order. Returns false
  /// where there are fewer nodes than the type has.
  bool add(int type, std::span<const std::uint32_t> nodes, std::uint32_t row);
  /// A polyhedron by its faces, each a ring.
  void add_polyhedron(std::span<const std::vector<std::uint32_t>> faces, std::uint32_t row);
  /// Tetrahedra that another has made of a cell, four nodes each.
  void add_tetrahedra(std::span<const std::uint32_t> nodes, std::uint32_t row);
  void leave_out(const std::string& kind) { ++left_out_[kind]; }

  /// What was cut, and what was left aside or out, in words.
  std::vector<std::string> notes() const;

  CellList cells;
  std::vector<std::uint32_t> rows;                       ///< of each cell: the row that it was added with
  std::vector<std::array<std::uint32_t, 4>> flat_cells;  ///< as GridBlock has them
  std::vector<std::uint32_t> flat_rows;
  std::size_t lines = 0, vertices = 0;  ///< left out

 private:
  bool comes_first(std::uint32_t a, std::uint32_t b) const;
  void piece(CellShape shape, std::initializer_list<std::uint32_t> nodes);
  void flat(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
  void fan(std::span<const std::uint32_t> ring);
  void cone(std::span<const std::vector<std::uint32_t>> faces);
  bool add_quadratic(CellShape shape, std::span<const std::uint32_t> nodes);
  bool add_lattice(std::span<const std::uint32_t> nodes, std::size_t order);
  bool add_solid(int type, std::span<const std::uint32_t> nodes);
  bool add_flat(int type, std::span<const std::uint32_t> nodes);

  std::span<const Vec3> places_;
  std::uint32_t row_ = 0;
  std::map<std::string, std::array<std::size_t, 2>> cut_;  ///< by their kind: cells, and those made of them
  std::map<std::string, std::size_t> left_out_, corners_only_;
};

}  // namespace sansmesh::inline v1::io
