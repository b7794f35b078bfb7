// Limits for the coordinates of a grid.
#pragma once

#include <string>

#include "sansmesh/box.h"
#include "sansmesh/grid_data.h"

namespace sansmesh::inline v1 {

/// Box of a lattice; the origin alone counts along axes without points.
Box3 lattice_box(const GridBlock& block);

/// Returns the reason why a volume on this grid cannot be computed: coordinates beyond `kLargestOfVolume`, or an extent
/// below `kSmallestOfVolume`; empty if it can. Some results are stored as float after scaling, and the scale itself
/// must be representable.
std::string out_of_limits(const GridData& data);

}  // namespace sansmesh::inline v1
