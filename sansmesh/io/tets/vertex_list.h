// Lists of fixed vertices in separate files (.bou).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::inline v1 {

/// The integers of a text file, separated by commas, blanks or line ends; comments begin with '#'. They are returned
/// unchanged (Vega counts vertices from 1). Throws FileError if the file is missing, empty, or holds anything else.
std::vector<std::uint64_t> read_vertex_list(const std::string& file);
/// The same from text; errors name `file`.
std::vector<std::uint64_t> parse_vertex_list(std::string_view text, const std::string& file);

}  // namespace sansmesh::inline v1
