// Limits of the coordinates of a grid.
#pragma once

#include <string>

#include "sansmesh/box.h"
#include "sansmesh/grid_data.h"

namespace sansmesh::inline v1 {

/// Box of a lattice; the origin alone counts along axes without points.
Box3 lattice_box(const GridBlock& block);

/// Why a volume of this grid cannot be computed: coordinates beyond `kLargestOfVolume`, or an extent below
/// `kSmallestOfVolume`. Some of what is made of a volume is float in a unit that suits it, and the unit itself has to
/// fit, too. Empty if nothing is in the way.
std::string out_of_limits(const GridData& data);

}  // namespace sansmesh::inline v1
