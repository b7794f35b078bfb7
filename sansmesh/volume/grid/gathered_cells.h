// The points and cells of several blocks in one list.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Points and cells with where they come from.
struct GatheredCells {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> point_row;    ///< in its block
  std::vector<std::uint16_t> point_block;  ///< as the file numbers them; of all, if there are several
  std::vector<std::uint8_t> joinable;      ///< of each point: not 0 if others may lie at its place
  CellList cells;
  std::vector<std::uint32_t> cell_row;    ///< in its block
  std::vector<std::uint16_t> cell_block;  ///< as above
  /// Of each cell the place that its value belongs to; only where that was asked for.
  std::vector<Vec3> centers;
};

}  // namespace sansmesh::inline v1
