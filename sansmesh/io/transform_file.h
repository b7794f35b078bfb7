// Reads and writes affine maps: 4 rows of 4 numbers.
#pragma once

#include <string>
#include <string_view>

#include "sansmesh/local_frame.h"

namespace sansmesh::inline v1 {

/// Reads a map that acts on columns: 4 rows of 4 numbers, separated by blanks, commas or semicolons, the last row 0 0 0
/// 1 (or absent: 3 rows of 4), the usual exchange format of point cloud programs. Lines after '#' or "//" are comments.
/// Also JSON: a list of rows, a list of 12 or 16 numbers row by row, or an object with such a list as its `matrix`.
/// Throws FileError if there is no such list, the last row differs, or the matrix has no inverse.
AffineMap read_transform(const std::string& file);
/// The same from text; errors name `file`.
AffineMap parse_transform(std::string_view text, const std::string& file);

/// Writes 4 rows of 4 numbers, the shortest that read back as the same; with the ending .json as {"matrix": [rows]}.
/// Throws FileError.
void write_transform(const std::string& file, const AffineMap& map);

}  // namespace sansmesh::inline v1
