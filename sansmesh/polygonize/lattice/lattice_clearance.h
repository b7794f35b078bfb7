// Moves lattice vertices away from sheets of the surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/polygonize/lattice/lattice.h"
#include "sansmesh/polygonize/pieces/piece_blocks.h"

namespace sansmesh::inline v1 {

/// Positions of the lattice vertices: none so close to a sheet that tiny corners are cut off, and none inside a thin
/// wall, whose two sheets would be divided in different ways. `numbers[first[i]] ...` are the vertices of leaf i.
std::vector<Vec3> clear_lattice(const PieceExpression& field, const PieceBlocks& blocks,
                                const std::vector<std::uint32_t>& numbers, const std::vector<std::size_t>& first,
                                const std::vector<LatticePoint>& points);

}  // namespace sansmesh::inline v1
