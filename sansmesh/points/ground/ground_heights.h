// Height grid of the ground.
#pragma once

#include "sansmesh/image.h"
#include "sansmesh/point_set.h"
#include "sansmesh/polyline_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct GroundHeightOptions {
  double cell = 0;     ///< edge of the cells (length), > 0; borders are multiples of it
  double spacing = 0;  ///< spacing of the samples over x and y (length), > 0
  double gap = 0;      ///< cells in wider gaps between the samples are unknown (length)
  /// Lines at which height or slope jumps, in world coordinates; null or empty: none. A line whose heights are all 0
  /// has none.
  const PolylineSet* breaklines = nullptr;
};

/// Height grid of samples.
struct GroundHeights {
  HeightGrid grid;
  std::size_t breaklines = 0;  ///< number of breaklines over the samples
};

/// Heights of a smooth surface through all samples at the centres of the cells: planes through the samples around each
/// centre, weighted by the distance, robust against single samples. Gaps have planes through means of more distant
/// samples. Cells outside of the samples are unknown.
///
/// Planes have no samples from the other side of a breakline: those to which a straight line crosses it. The heights of
/// the line are samples of each side that they continue: at the foot of a wall, those of its top do not count. Cells
/// between lines take the few samples that they see; those that see none are filled as without breaklines.
///
/// Throws DataError if there are too many cells.
GroundHeights make_ground_heights(const PointSet& points, const GroundHeightOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
