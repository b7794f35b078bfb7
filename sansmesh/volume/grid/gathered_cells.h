// The points and cells of several blocks in one list.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Points and cells with their origin in the file.
struct GatheredCells {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> point_row;    ///< row in its block
  std::vector<std::uint16_t> point_block;  ///< block number in the file; empty for a single block
  std::vector<std::uint8_t> joinable;      ///< per point: not 0 if other points may coincide with it
  CellList cells;
  std::vector<std::uint32_t> cell_row;    ///< row in its block
  std::vector<std::uint16_t> cell_block;  ///< as above
  /// Number from 0 that the pieces of one cell of the file share; empty if all cells are whole.
  std::vector<std::uint32_t> cell_whole;
  std::uint32_t wholes = 0;  ///< count of these numbers
  HigherOrderCells higher;   ///< only without centers; `of_piece` is as long as `cells`, or empty
  /// Position of each cell's value; only if requested.
  std::vector<Vec3> centers;
};

}  // namespace sansmesh::inline v1
