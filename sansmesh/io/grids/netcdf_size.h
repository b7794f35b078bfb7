// Whether a NetCDF file is as long as its header says: the library that reads it fills what is missing with zeros.
#pragma once

#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

/// Throws FileError where the header of a classic NetCDF file ("CDF" and a byte 1, 2 or 5) is damaged or announces more
/// than there is. Format: NetCDF Users Guide, appendix B (classic, 64-bit offset, 64-bit data).
void check_netcdf_size(const Input& in);

}  // namespace sansmesh::inline v1::io
