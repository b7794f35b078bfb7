// The points and cells of all blocks of a file in one list.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/gathered_cells.h"

namespace sansmesh::inline v1 {

/// All that is visible and finite: hidden points take their cells along. Blocks in the order given, the rows of those
/// without structure in that of canonical_rows. Layers and flat cells become one slab, unless there are cells with
/// volume, too. Scattered points have no cells here. Blocks must be sound (check_blocks). Counts into facts: blocks,
/// points, cells, hidden, not_finite, layer.
GatheredCells gather_cells(const GridData& data, const std::vector<std::size_t>& order, bool centers,
                           VolumeFacts& facts);

}  // namespace sansmesh::inline v1
