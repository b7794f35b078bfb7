// Growth of the ground from its seeds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/points/ground/ground_grid.h"

namespace sansmesh::inline v1 {

/// Tolerance of the distance of a sample from a plane through ground on one of its sides.
struct GroundTolerance {
  double cells = 0;       ///< in cells of the grid
  double deviations = 0;  ///< in standard deviations of the ground from the plane
  double slope = 0;       ///< length for each unit of slope
};

/// Whether a sample continues the ground on one of its sides: for one of eight half planes, it is close to the plane
/// through the lowest samples of the cells with `ground` around it. One side suffices, as edges of terraces and cliffs
/// have ground of other heights on the other one.
bool continues_ground(const PointSet& points, const GroundGrid& grid, const std::vector<std::uint8_t>& ground,
                      std::size_t sample, const GroundTolerance& tolerance);

/// Adds cells whose lowest samples continue the ground, for a limited number of rounds.
void grow_ground(const PointSet& points, const GroundGrid& grid, std::vector<std::uint8_t>& ground,
                 const GroundTolerance& tolerance);

}  // namespace sansmesh::inline v1
