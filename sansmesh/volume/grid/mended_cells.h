// Cells as reconstructions need them: corners at one place are one corner, none is flat or inside out.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/gathered_cells.h"

namespace sansmesh::inline v1 {

/// Points at one place become the first of them (coincident_points): renames the corners of cells. Returns for each
/// point that first one; empty if there are none to join.
std::vector<std::uint32_t> join_coincident(GatheredCells& gathered);

/// Replaces cells whose corners coincide by those of fewer corners, leaves those without volume out and turns those
/// that are inside out. Counts into facts: degenerate, inverted. Returns for each cell that is left its number before;
/// empty if these are the same.
std::vector<std::uint32_t> mend_cells(GatheredCells& gathered, VolumeFacts& facts);

}  // namespace sansmesh::inline v1
