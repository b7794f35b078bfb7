// Gathers the points and cells of all blocks in one list.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/gathered_cells.h"

namespace sansmesh::inline v1 {

/// Includes all visible and finite points; hidden points remove their cells. Blocks are in the given order, rows
/// without structure in that of canonical_rows. Layers and flat cells become one slab unless there are solid cells.
/// Scattered points get no cells here. Blocks must be valid (check_blocks). Adds to facts: blocks, points, cells,
/// hidden, not_finite, layer.
GatheredCells gather_cells(const GridData& data, const std::vector<std::size_t>& order, bool centers,
                           VolumeFacts& facts);

}  // namespace sansmesh::inline v1
