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
  /// (9.96921e36, and of signed integers of 16, 32 and 64 bits the least ones), the largest float and double, a power
  /// of ten from 1e20 on, 1.70141e38 (Surfer), 9.999e20 (GRIB), −9.99e8 and −9.99e33 (GrADS), −999, −999.25 (well
  /// logs), −9999, −99999, −999999.
  bool usual = true;

  /// Throws ArgumentError naming the field.
  void validate() const;
};

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

}  // namespace sansmesh
