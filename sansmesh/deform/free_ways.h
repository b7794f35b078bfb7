// Lengths of detours around a surface, on a lattice.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/deform/triangle_sheet.h"

namespace sansmesh::inline v1 {

/// A lattice over a box, with the links that a sheet cuts. From a source, visible nodes are reached straight. Paths to
/// the others are found in order of length: each node stores the last bend of its path, from which the path is
/// straight; its neighbours, if the sheet does not cross the link between them, adopt that bend if they see it. If the
/// sheet intervenes, one of its border or bent edges crosses the narrow triangle of bend, node and neighbour; the
/// crossing becomes the next bend. Lengths are therefore those of real paths, straight between bends on edges, and
/// exceed the shortest by a fraction of a cell.
class FreeWays {
 public:
  /// Cubic cells, `cells` along the longest side of the box, which is enlarged to whole cells. The sheet must outlive
  /// this.
  FreeWays(const TriangleSheet& sheet, const Box3& box, int cells);

  /// Extra length of unreachable nodes: a million times the lattice's size.
  double unreachable() const { return unreachable_; }

  /// For every node the extra length, >= 0, of the path from `from` over the distance. Parallel.
  std::vector<float> extras(const Vec3& from) const;

  /// Interpolates values at the nodes: linear, using the nodes on the same side of the sheet as x. Where a node becomes
  /// visible around the border its weight grows gradually, within half a cell of the border, so that the result is
  /// continuous in x except across the sheet. Outside the lattice the nearest point of it is used; the result is 0
  /// where x is not finite. The gradient is that of the interpolation.
  struct Value {
    double value = 0;
    Vec3 gradient;
  };
  Value interpolate(const std::vector<float>& values, const Vec3& x) const;

  const Box3& box() const { return box_; }
  double spacing() const { return spacing_; }

 private:
  Vec3 place(std::size_t node) const;
  Vec3 place(const std::array<std::size_t, 3>& at) const;
  std::size_t index(const std::array<std::size_t, 3>& at) const { return (at[2] * n_[1] + at[1]) * n_[0] + at[0]; }
  struct Bend;
  struct March;
  void relax(March& march, std::size_t from, std::size_t to) const;
  double in_cut_cell(const std::vector<float>& values, const std::array<std::size_t, 3>& cell, const Vec3& x) const;

  const TriangleSheet& sheet_;
  Box3 box_;
  double spacing_ = 0, unreachable_ = 0;
  std::array<std::size_t, 3> n_{};       // nodes per axis
  std::array<std::size_t, 3> stride_{};  // index step between neighbours
  std::vector<std::uint8_t> closed_;  // per node: bit k set if the sheet crosses the link to the next node along axis k
  std::vector<std::uint8_t> cut_;     // per node: the cell that starts there may contain part of the sheet
};

}  // namespace sansmesh::inline v1
