// Fill values: numbers that stand for missing ones in arrays of volumes.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/volume_read_options.h"

namespace sansmesh::inline v1 {

/// Makes fill values NaN, with all components of their row; arrays of integers that have some become real. Returns a
/// line for each fill value that says in which arrays and how often; where one of `values` is nowhere that is said,
/// too.
///
/// A usual fill value stands apart where hardly any other number lies around it, within half of the distance to the
/// rest of the array (the farthest hundredth left out), and that distance is no less than the rest spans: twice that
/// where it is there only once, 0.4 of that where it is there ten times or more. A line names one that is nearer. A
/// quantity that passes through −9999 keeps it. A power of ten has to be the only one, and 10¹⁰ times as large as the
/// rest.
std::vector<std::string> mark_fill_values(GridData& data, const FillValueOptions& options);

}  // namespace sansmesh::inline v1
