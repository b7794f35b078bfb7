// Whether a file of CGNS's older database is as long as its header says: the library that reads it makes up the rest.
#pragma once

#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

/// Throws FileError where an ADF file ("ADF Database") ends before its header says. The header holds the place of the
/// end behind that of the root: blocks of 4,096 bytes and bytes, 8 and 4 hexadecimal digits.
void check_adf_size(const Input& in);

}  // namespace sansmesh::inline v1::io
