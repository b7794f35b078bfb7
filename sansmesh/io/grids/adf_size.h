// Checks that a file of CGNS's older database (ADF) is as long as its header states: the reading library invents
// missing data.
#pragma once

#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

/// Throws FileError if an ADF file ("ADF Database") ends before its header states. The header holds the position of the
/// end behind that of the root: blocks of 4,096 bytes and bytes, 8 and 4 hexadecimal digits.
void check_adf_size(const Input& in);

}  // namespace sansmesh::inline v1::io
