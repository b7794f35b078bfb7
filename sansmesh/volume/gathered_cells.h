// The points and cells of all blocks of a file in one list, and what is mended in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/cell_list.h"
#include "sansmesh/data/grid_data.h"
#include "sansmesh/data/sampled_volume.h"

namespace sansmesh {

/// Points and cells with where they come from.
struct GatheredCells {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> point_row;    ///< in its block
  std::vector<std::uint16_t> point_block;  ///< as the file numbers them; of all, if there are several
  std::vector<std::uint8_t> joinable;      ///< of each point: not 0 if others may lie at its place
  CellList cells;
  std::vector<std::uint32_t> cell_row;    ///< in its block
  std::vector<std::uint16_t> cell_block;  ///< as above
  /// Of each cell the place that its value belongs to; only where that was asked for.
  std::vector<Vec3> centers;
};

/// An order of the blocks that depends on what they hold, not on how they are listed.
std::vector<std::size_t> canonical_order(const GridData& data);

/// All that is visible and finite: hidden points take their cells along. Layers and flat cells become slabs, unless
/// there are cells with volume, too. Scattered points have no cells here. Counts into facts: points, cells, hidden,
/// not_finite, layer. Throws DataError where cells name points that are not there, arrays or flags have not as many
/// rows as there are points or cells, and where there is nothing but lines or points.
GatheredCells gather_cells(const GridData& data, const std::vector<std::size_t>& order, bool centers,
                           VolumeFacts& facts);

/// Scattered points, neighbours near each other in an order that depends on their places alone, with the cells of their
/// Delaunay tetrahedralisation; `first` is what join_coincident returns (points nearer to each other than 1e-9 of the
/// whole are one). Counts into facts: hidden, not_finite. Throws as delaunay_tetrahedra.
GatheredCells gather_scattered(const GridData& data, const std::vector<std::size_t>& order, VolumeFacts& facts,
                               std::vector<std::uint32_t>& first);

/// Points at one place, to a hundredth of the shortest edge there and 1e-6 of the whole, become the first of them:
/// renames the corners of cells. Returns for each point that first one; empty if there are none to join.
std::vector<std::uint32_t> join_coincident(GatheredCells& gathered);

/// Replaces cells whose corners coincide by those of fewer corners, leaves those without volume out and turns those
/// that are inside out. Counts into facts: degenerate, inverted. Returns for each cell that is left its number before;
/// empty if these are the same.
std::vector<std::uint32_t> mend_cells(GatheredCells& gathered, VolumeFacts& facts);

}  // namespace sansmesh
