// Is a cloud a terrain: one height for each place on the ground?
#pragma once

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// How much of a cloud looks like heights over x and y.
struct HeightFieldShape {
  /// Share of the samples whose column, a square with about 16 samples, they fill as one sheet: near 1 for terrain,
  /// less where trees and walls stand on it, near 0 for whatever has an underside or stands upright.
  double one_sheet = 0;
  /// Height of the middle half of the samples above and below the plane through all, over the edge of the square that
  /// has the area of all columns.
  double relief = 0;
};

/// `noise` (length): sheets are that thick by themselves. Samples without finite positions do not count.
HeightFieldShape measure_height_field(const PointSet& points, double noise);

/// Whether up is the side from which such a cloud is looked at: it is flat on the whole, and enough of it is one sheet.
/// Of a `survey` from the air, known by other signs, a tenth is enough: under trees there is little ground.
bool is_height_field(const HeightFieldShape& shape, bool survey);

}  // namespace sansmesh::inline v1
