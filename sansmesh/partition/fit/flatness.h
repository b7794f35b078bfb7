// Flatness of the surface around each block, which determines the size of mesh blocks.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/partition/fit/scale_choice.h"

namespace sansmesh::inline v1 {

/// Distance between the surface and linear triangles of half a block's edge, in a cell of the tree (length).
float flatness_gap(const BlockFitter& fitter, const ScaleChoice& choice, int level, std::uint32_t cell);

/// Limits the flatness of a block with a crease, and of all blocks above and below it, to that of a chamfer of its
/// lattice. Codes and gaps of all levels; `edge` of the root cube; `least_cosine` of the pieces that meet
/// (crease_fit.h).
void mark_crease(const std::vector<std::vector<std::uint64_t>>& code, std::vector<std::vector<float>>& gap, float edge,
                 int level, std::uint64_t block, float least_cosine);

}  // namespace sansmesh::inline v1
