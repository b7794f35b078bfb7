// Orders that follow from what blocks, points and cells are, not from how a file lists them: what is assembled of them
// is the same to the bit then, and neighbours in space are neighbours in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/grid_data.h"

namespace sansmesh::inline v1 {

/// Of the blocks: coarse levels first, then by what they hold. Blocks must be sound (check_blocks).
std::vector<std::size_t> canonical_order(const GridData& data);

/// Of the rows of a block without structure: points along the Morton curve of their box, of one cell of it by x, y and
/// z, of one place by their values; cells (flat ones, where there are no others) likewise by the means of their
/// corners, then by their corners in the order that the cell has them, then by their values. What is not finite comes
/// last. The rows in their new order; empty for structured blocks, which keep theirs.
struct BlockRows {
  std::vector<std::uint32_t> points, cells;
};
BlockRows canonical_rows(const GridBlock& block);

/// Tells rows of points apart that lie at one place: something like a hash of all their values.
std::uint64_t digest_of_point(const GridBlock& block, std::size_t row);

}  // namespace sansmesh::inline v1
