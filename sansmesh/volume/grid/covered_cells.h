// Cells covered by finer cells of other blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/volume/grid/gathered_cells.h"

namespace sansmesh::inline v1 {

/// Removes cells inside visible cells of finer lattice levels (AMR), even if the file does not mark them as covered.
/// Returns their number.
std::size_t remove_below_levels(const GridData& data, GatheredCells& gathered);

/// Marks cells entirely covered by a block that is finer there, by mean edge length (among equally fine ones the cell
/// whose centre is first by x, y and z stays). A cell is only marked if remaining cells cover it completely. `block`:
/// block of each cell.
std::vector<std::uint8_t> overlapped_cells(const CellList& cells, const std::vector<Vec3>& points,
                                           const std::vector<std::uint16_t>& block);

}  // namespace sansmesh::inline v1
