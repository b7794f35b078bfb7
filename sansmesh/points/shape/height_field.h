// Detects terrain: clouds that are height fields over x and y.
#pragma once

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Measures of a cloud as a height field.
struct HeightFieldShape {
  /// Share of samples in columns (squares with about 16 samples) that they fill as a single sheet: near 1 for terrain,
  /// less with trees and walls, near 0 for objects with an underside or upright surfaces.
  double one_sheet = 0;
  /// Interquartile range of the heights over the plane through all samples, relative to the edge of a square with the
  /// area of all columns.
  double relief = 0;
};

/// `noise` (length) is the thickness of a single sheet. Ignores samples without finite positions.
HeightFieldShape measure_height_field(const PointSet& points, double noise);

/// Whether the cloud is a height field seen from above: flat overall, with a sufficient share of single sheets. For a
/// `survey` known to be airborne a tenth suffices, as little ground is visible under trees.
bool is_height_field(const HeightFieldShape& shape, bool survey);

}  // namespace sansmesh::inline v1
