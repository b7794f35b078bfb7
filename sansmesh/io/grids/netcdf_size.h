// Checks that a NetCDF file is as long as its header states: the reading library fills missing data with zeros.
#pragma once

#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

/// Throws FileError if the header of a classic NetCDF file ("CDF" and a byte 1, 2 or 5) is damaged or announces more
/// data than the file holds. Format: NetCDF Users Guide, appendix B (classic, 64-bit offset, 64-bit data).
void check_netcdf_size(const Input& in);

}  // namespace sansmesh::inline v1::io
