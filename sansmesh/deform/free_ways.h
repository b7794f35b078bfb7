// How much longer ways get by a surface that stands in between: on a lattice.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/deform/triangle_sheet.h"

namespace sansmesh::inline v1 {

/// A lattice over a box with what of it a sheet cuts. From a place, nodes that it sees are straight away. Ways to the
/// others are found in the order of their lengths: each node knows the last bend of its way, from which it is straight
/// to it, and its neighbours, with which it is linked unless the sheet crosses the link, take that bend over where they
/// see it. Where the sheet comes in between, an edge at which it ends or is bent passes through the narrow triangle of
/// bend, node and neighbour, and becomes the place of the next bend. So lengths are those of real ways, straight
/// between bends on edges, and miss the shortest by a share of a cell that shrinks with its size.
class FreeWays {
 public:
  /// Cubes, `cells` along the longest side of the box, which is grown to whole cells. The sheet must outlive it.
  FreeWays(const TriangleSheet& sheet, const Box3& box, int cells);

  /// What cannot be reached at all is this much farther: a million times as long as the lattice.
  double unreachable() const { return unreachable_; }

  /// For every node the length that ways from `from` get longer by, >= 0. Parallel.
  std::vector<float> extras(const Vec3& from) const;

  /// Of values at the nodes: linear in between, from the nodes that lie on the same side of the sheet as x. Where a
  /// node comes into sight around the border its weight grows gradually, within half a cell of the border, so that the
  /// result is continuous in x but across the sheet. Beyond the lattice that of the nearest place in it; 0 where x is
  /// not finite. The gradient is that of the interpolation.
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
  std::array<std::size_t, 3> n_{};       // nodes
  std::array<std::size_t, 3> stride_{};  // between neighbours
  std::vector<std::uint8_t> closed_;     // of each node: bit k set, the link to the next one along axis k is crossed
  std::vector<std::uint8_t> cut_;        // of each node: the cell that begins there may hold a part of the sheet
};

}  // namespace sansmesh::inline v1
