// Seeds of the ground: cells whose lowest samples remain in a progressive morphological opening.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/points/ground/ground_grid.h"
#include "sansmesh/points/ground/ground_trend.h"

namespace sansmesh::inline v1 {

/// 1 for cells with seeds [pingel2013]. The window of the opening grows; a cell is an object where the surface falls by
/// more than a slope times the window. A trend, unless it is empty, is subtracted first: windows do not cut hills then,
/// and on steep ground the tolerance grows with the slope.
std::vector<std::uint8_t> find_ground_seeds(const PointSet& points, const GroundGrid& grid, const GroundTrend& trend);

}  // namespace sansmesh::inline v1
