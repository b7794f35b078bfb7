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
#include "sansmesh/io/vtk/higher_order_cells.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::io {

/// Collects cells and cuts them if needed. Cells of higher order are cut at all of their nodes, and keep their kind and
/// nodes in `higher`. (Triquadratic pyramids are cut at the nodes of their edges; of Bézier cells, Lagrange pyramids,
/// and Lagrange cells with other numbers of nodes than their order has, only the corners are used.) Polyhedra become
/// tetrahedra that share the first node (by x, then y, then z, then number), and their faces triangles that share
/// theirs. So cells with a common face are cut alike there, whatever the order of the nodes. Cells keep VTK's
/// orientation; inverted cells stay inverted.
class LinearCells : public CellPieces {
 public:
  /// Positions of the nodes; must outlive this.
  explicit LinearCells(std::span<const Vec3> points) : CellPieces(points) {}

  /// `type` is VTK's number of a linear, quadratic or Lagrange cell; nodes are in VTK's order. Returns false if there
  /// are fewer nodes than the type has.
  /// `degrees`: those of a Lagrange cell along its axes, if the file states them.
  bool add(int type, std::span<const std::uint32_t> nodes, std::uint32_t row, std::array<int, 3> degrees = {});
  /// A polyhedron by its faces, each a ring of nodes.
  void add_polyhedron(std::span<const std::vector<std::uint32_t>> faces, std::uint32_t row);
  /// Tetrahedra of a cell cut elsewhere, four nodes each.
  void add_tetrahedra(std::span<const std::uint32_t> nodes, std::uint32_t row);
  void leave_out(const std::string& kind) { ++left_out_[kind]; }

  /// Notes on cells that were cut or skipped and on ignored nodes.
  std::vector<std::string> notes() const;

  std::vector<std::array<std::uint32_t, 4>> flat_cells;  ///< as in GridBlock
  std::vector<std::uint32_t> flat_rows;
  std::size_t lines = 0, vertices = 0;  ///< skipped

 private:
  void flat(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
  void fan(std::span<const std::uint32_t> ring);
  bool add_quadratic(CellShape shape, std::span<const std::uint32_t> nodes);
  bool add_solid(int type, std::span<const std::uint32_t> nodes);
  bool add_quadratic_solid(int type, std::span<const std::uint32_t> nodes);
  bool add_higher_order(int type, std::span<const std::uint32_t> nodes);
  bool add_flat(int type, std::span<const std::uint32_t> nodes);

  std::array<int, 3> degrees_{};
  std::map<std::string, std::array<std::size_t, 2>> cut_, shaped_;  ///< by kind: cells, and pieces made of them
  std::map<std::string, std::size_t> left_out_, corners_only_;
};

}  // namespace sansmesh::inline v1::io
