// Lengths of detours around a surface, on a lattice.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/deform/cuts/occluder.h"
#include "sansmesh/deform/cuts/triangle_sheet.h"
#include "sansmesh/deform/maps/box_lattice.h"

namespace sansmesh::inline v1 {

/// A lattice over a box, with the links that a sheet cuts. From a source, visible nodes are reached straight. Paths to
/// the others are found in order of length: each node stores the last bend of its path, from which the path is
/// straight; its neighbours, if the sheet does not cross the link between them, adopt that bend if they see it. If the
/// sheet intervenes, one of its border or bent edges crosses the narrow triangle of bend, node and neighbour; the
/// crossing becomes the next bend. Lengths are therefore those of real paths, straight between bends on edges, and
/// exceed the shortest by a fraction of a cell.
class DetourLattice {
 public:
  /// Cubic cells, `cells` along the longest side of the box, which is enlarged to whole cells. The sheet must outlive
  /// this.
  DetourLattice(const TriangleSheet& sheet, const Box3& box, int cells);

  /// For every node the extra length, >= 0, of the path from `from` over the distance. Parallel.
  std::vector<float> extra_lengths(const Vec3& from) const;

  /// Interpolates values at the nodes: linear, using the nodes on the same side of the sheet as x. Where a node becomes
  /// visible around the border its weight grows gradually, within half a cell of the border, so that the result is
  /// continuous in x except across the sheet. Outside the lattice the nearest point of it is used; the result is 0
  /// where x is not finite. The gradient is that of the interpolation.
  Detour interpolate(const std::vector<float>& values, const Vec3& x) const;

 private:
  struct Bend;
  struct March;
  void relax(March& march, std::size_t from, std::size_t to) const;
  double in_cut_cell(const std::vector<float>& values, const std::array<std::size_t, 3>& cell, const Vec3& x) const;

  const TriangleSheet& sheet_;
  BoxLattice lattice_;
  double spacing_ = 0;                ///< edge of the cubic cells
  double unreachable_ = 0;            ///< extra length of unreachable nodes: a million times the lattice's size
  std::vector<std::uint8_t> closed_;  ///< per node: bit k set if the sheet crosses the link along axis k
  std::vector<std::uint8_t> cut_;     ///< per node: the cell that starts there may contain part of the sheet
};

}  // namespace sansmesh::inline v1
