// Fill values: numbers that stand for missing ones in arrays of volumes.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/data/grid_data.h"

namespace sansmesh {

/// Which numbers count as missing besides NaN and infinite ones.
struct FillValueOptions {
  std::vector<double> values;  ///< wherever they occur; finite
  /// Also the usual ones where they stand clearly apart from all other numbers of the array: NetCDF's defaults
  /// (9.96921e36, and the least integers), the largest float and double, powers of ten from 1e20 on, 1.70141e38
  /// (Surfer), 9.999e20 (GRIB), −9.99e8 and −9.99e33 (GrADS), −999, −999.25 (well logs), −9999, −99999, −999999.
  bool usual = true;

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Makes fill values NaN, with all components of their row; arrays of integers that have some become real. Returns a
/// line for each fill value that says in which arrays and how often; where one of `values` is nowhere that is said,
/// too.
///
/// A usual fill value stands apart where the rest of the array (the farthest hundredth left out) spans no more than the
/// distance to it, half of that where it is there only once, and hardly any other number lies around it, within half of
/// that distance. A quantity that passes through −9999 keeps it.
std::vector<std::string> mark_fill_values(GridData& data, const FillValueOptions& options);

}  // namespace sansmesh
