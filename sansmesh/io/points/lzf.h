// LZF, the fast compression inside PCD files.
#pragma once

#include <span>
#include <string_view>

namespace sansmesh::inline v1::io {

/// Decompresses `packed` into exactly `out`; false if the data are damaged or do not fill it.
bool lzf_decompress(std::string_view packed, std::span<char> out);

}  // namespace sansmesh::inline v1::io
