// Gathers the points and cells of all blocks in one list.
#pragma once

#include <cstddef>
#include <cstdint>
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

/// Number of a point that is no corner of a cell.
inline constexpr std::uint32_t kUnused = 0xffffffffu;

/// The cells of higher order whose nodes are distinct samples: `number` of each point, or kUnused; `source` is the
/// previous index of each of the `cells`, empty if unchanged.
HigherOrderCells kept_higher(const HigherOrderCells& all, const std::vector<std::uint32_t>& source,
                             const std::vector<std::uint32_t>& number, std::size_t cells);

}  // namespace sansmesh::inline v1
