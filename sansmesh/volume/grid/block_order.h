// Canonical orders of blocks, points and cells. They depend on the contents, not on the order in the file, so that
// assembled volumes are bit-identical and neighbours in space are close in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/grid_data.h"

namespace sansmesh::inline v1 {

/// Order of the blocks: coarse levels first, then by contents. Blocks must be valid (check_blocks).
std::vector<std::size_t> canonical_order(const GridData& data);

/// Row order of a block without structure. Points: along the Morton curve of their box, within one cell of the curve by
/// x, y and z, coincident ones by value. Cells (flat ones if there are no others): likewise by the mean of their
/// corners, then by their corners in the order of the cell, then by value. Non-finite rows come last. Empty for
/// structured blocks, which keep their order.
struct BlockRows {
  std::vector<std::uint32_t> points, cells;
};
BlockRows canonical_rows(const GridBlock& block);

/// Distinguishes coincident points: a hash of all their values.
std::uint64_t digest_of_point(const GridBlock& block, std::size_t row);

}  // namespace sansmesh::inline v1
