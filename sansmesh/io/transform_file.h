// Affine maps in files: 4 rows of 4 numbers.
#pragma once

#include <string>
#include <string_view>

#include "sansmesh/local_frame.h"

namespace sansmesh::inline v1 {

/// A map that takes positions as columns: 4 rows of 4 numbers between blanks, commas or semicolons, the last 0 0 0 1
/// (or absent: 3 rows of 4), as most programs for clouds exchange them; lines after '#' or "//" are comments. Or as
/// JSON: a list of rows, a list of 12 or 16 numbers row by row, or an object with such a list as its `matrix`. Throws
/// FileError where there is no such thing, where the last row is another, or where the matrix has no inverse.
AffineMap read_transform(const std::string& file);
/// The same of a text; `file` is named in errors.
AffineMap parse_transform(std::string_view text, const std::string& file);

/// Writes 4 rows of 4 numbers, the shortest that read back as the same; with the ending .json as {"matrix": [rows]}.
/// Throws FileError.
void write_transform(const std::string& file, const AffineMap& map);

}  // namespace sansmesh::inline v1
