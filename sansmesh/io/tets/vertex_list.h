// Lists of vertices in files of their own (.bou): which ones are held.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::inline v1 {

/// The whole numbers of a text file, with commas, blanks or line ends between them; what follows a '#' is skipped. They
/// are as the file has them (Vega counts vertices from 1 on). Throws FileError where it is missing, empty, or holds
/// anything else.
std::vector<std::uint64_t> read_vertex_list(const std::string& file);
/// The same of a text; `file` is named in errors.
std::vector<std::uint64_t> parse_vertex_list(std::string_view text, const std::string& file);

}  // namespace sansmesh::inline v1
