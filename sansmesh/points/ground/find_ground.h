// Ground filter: finds the samples of the terrain in an airborne survey without classes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct GroundSamples {
  std::vector<std::uint8_t> ground;  ///< 1 for samples of the ground, 0 for all others
  std::size_t count = 0;             ///< samples of the ground
  double cell = 0;                   ///< edge of the cells (length): spacing of the samples over x and y
};

/// Lengths are relative to the spacing, so the unit of the coordinates is irrelevant; heights have the same unit as x
/// and y, and z points up. Independent of existing classes. Throws DataError if the samples cover no area over x and y.
/// (docs/methods/ground.md)
GroundSamples find_ground(const PointSet& points, Progress& progress);

}  // namespace sansmesh::inline v1
