// Cells whose place finer ones of other blocks take.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/volume/grid/gathered_cells.h"

namespace sansmesh::inline v1 {

/// Takes out the cells that lie in visible cells of lattices of finer levels (AMR), also where the file does not say
/// that these cover them. Returns how many.
std::size_t remove_below_levels(const GridData& data, GatheredCells& gathered);

/// Which cells lie wholly in a block that is finer there, by the mean length of edges (of equally fine ones the one
/// whose middle comes first, by x, y and z, stays). Only cells are marked all of whose place is taken by cells that
/// stay. `block` of each cell.
std::vector<std::uint8_t> overlapped_cells(const CellList& cells, const std::vector<Vec3>& points,
                                           const std::vector<std::uint16_t>& block);

}  // namespace sansmesh::inline v1
