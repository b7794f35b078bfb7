// Repairs cells for reconstructions: joins coincident corners, removes flat cells and inverts inverted ones.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/gathered_cells.h"

namespace sansmesh::inline v1 {

/// Replaces coincident points by the first of them (coincident_points) in the corners of cells. Returns that first
/// point for each point; empty if there are none to join.
std::vector<std::uint32_t> join_coincident(GatheredCells& gathered);

/// Replaces cells with coincident corners by cells with fewer corners, removes cells without volume and turns inverted
/// ones. Adds to facts: degenerate, inverted. Returns the previous index of each remaining cell; empty if indices are
/// unchanged.
std::vector<std::uint32_t> repair_cells(GatheredCells& gathered, VolumeFacts& facts);

}  // namespace sansmesh::inline v1
