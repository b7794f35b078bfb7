// Height grid of the ground.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct GroundHeightOptions {
  double cell = 0;     ///< edge of the cells (length), > 0; borders are multiples of it
  double spacing = 0;  ///< spacing of the samples over x and y (length), > 0
  double gap = 0;      ///< cells in wider gaps between the samples are unknown (length)
};

/// Heights of a smooth surface through all samples at the centres of the cells: planes through the samples around each
/// centre, weighted by the distance, robust against single samples. Gaps have planes through means of more distant
/// samples. Cells outside of the samples are unknown. Throws DataError if there are too many cells.
HeightGrid make_ground_heights(const PointSet& points, const GroundHeightOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
