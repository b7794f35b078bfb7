// Contour lines of height grids.
#pragma once

#include <string>

#include "sansmesh/image.h"
#include "sansmesh/polyline_set.h"

namespace sansmesh::inline v1 {

/// Lines of equal height at all multiples of the interval (length, > 0), linear between the centres of cells, in
/// ascending order of heights. Closed lines end with their first point. The line attribute `height` (double) has their
/// heights. Throws ArgumentError if there would be more than 10,000 levels.
PolylineSet contours_of(const HeightGrid& grid, double interval);

/// Drawing with one path for each height, in the coordinates of the data (y up): its attribute data-height has the
/// height. Every fifth one is bold.
std::string contours_svg(const PolylineSet& contours, double interval);

/// DXF (AutoCAD R12): polylines with their height as elevation, on the layers CONTOUR and CONTOUR_INDEX (every fifth).
std::string contours_dxf(const PolylineSet& contours, double interval);

}  // namespace sansmesh::inline v1
