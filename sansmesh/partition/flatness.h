// How flat the surface is around each block: what the blocks of meshes follow. Internal to partition/.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/partition/scale_choice.h"

namespace sansmesh::inline v1 {

/// Gap that linear triangles of half a block's edge would leave on the surface in a cell of the tree (length).
float flatness_gap(const BlockFitter& fitter, const ScaleChoice& choice, int level, std::uint32_t cell);

/// A block with a crease, and all above and below it, are at most as flat as a chamfer of its lattice would be. Codes
/// and gaps of all levels; `edge` of the root cube.
void mark_crease(const std::vector<std::vector<std::uint64_t>>& code, std::vector<std::vector<float>>& gap, float edge,
                 int level, std::uint64_t block);

}  // namespace sansmesh::inline v1
