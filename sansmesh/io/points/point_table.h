// Reads query points from files: in order, in double precision, complete.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The positions of a text table (.csv, .txt, .xyz: columns named x, y and z, or the first three), or of any file of
/// points that read_points reads. In tables `nan` and empty fields are NaN. Throws FileError if the file is missing,
/// has no rows, or a row is not numeric (with its line).
std::vector<Vec3> read_point_table(const std::string& file);
/// The same from the text of a table; errors name `file`.
std::vector<Vec3> parse_point_table(std::string_view text, const std::string& file);

}  // namespace sansmesh::inline v1
