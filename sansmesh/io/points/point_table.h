// Places to look at, one a row of a file: in their order, in double precision, none left out.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The positions of a table of text (.csv, .txt, .xyz: columns named x, y and z, or the first three), or of any file of
/// points that read_points knows. In tables `nan` and empty fields are NaN. Throws FileError where the file is missing,
/// holds no rows, or a row is not one of numbers (with its line).
std::vector<Vec3> read_point_table(const std::string& file);
/// The same of the text of a table; `file` is named in errors.
std::vector<Vec3> parse_point_table(std::string_view text, const std::string& file);

}  // namespace sansmesh::inline v1
