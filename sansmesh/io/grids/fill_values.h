// Fill values: numbers that mark missing values in arrays of volumes.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/volume_read_options.h"

namespace sansmesh::inline v1 {

/// Replaces fill values by NaN in all components of their row; integer arrays with fill values become real. Returns one
/// line per fill value with the arrays and counts, also for each of `values` that does not occur.
///
/// A usual fill value is separate if hardly any other number is within half of its distance to the rest of the array
/// (without the farthest hundredth), and this distance is at least the range of the rest: twice the range if it occurs
/// once, 0.4 of it if it occurs ten times or more. A line names a usual value that is closer. A quantity that passes
/// through −9999 keeps it. A power of ten must be the only one, and 10¹⁰ times as large as the rest.
std::vector<std::string> mark_fill_values(GridData& data, const FillValueOptions& options);

}  // namespace sansmesh::inline v1
