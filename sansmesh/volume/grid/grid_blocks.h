// Sizes and validation of the blocks of a file.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "sansmesh/grid_data.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

inline bool is_structured(const GridBlock& b) { return b.kind == GridKind::lattice || b.kind == GridKind::curvilinear; }
/// Numbers of points along the axes of a structured block.
inline std::array<std::size_t, 3> dims_of(const GridBlock& b) {
  if (b.kind == GridKind::lattice) return {b.axes[0].size(), b.axes[1].size(), b.axes[2].size()};
  return b.dims;
}
std::size_t point_count_of(const GridBlock& b);
/// Flat cells count if there are no others.
std::size_t cell_count_of(const GridBlock& b);
/// The same, with the pieces of one cell of the file counted once.
std::size_t whole_count_of(const GridBlock& b);
/// Number of axes of a structured block with only one point.
inline std::size_t layers_of(const GridBlock& b) {
  const auto n = dims_of(b);
  return static_cast<std::size_t>(std::count(n.begin(), n.end(), std::size_t{1}));
}
/// Whether the block has cells with volume.
bool is_solid(const GridBlock& b);
/// Position of point i.
Vec3 point_of(const GridBlock& b, std::size_t i);

/// Throws DataError that names the block for cells with invalid point numbers, arrays or flags of wrong length, and
/// axes that do not increase; also for more than 65,536 blocks or 2³¹ points.
void check_blocks(const GridData& data);

}  // namespace sansmesh::inline v1
