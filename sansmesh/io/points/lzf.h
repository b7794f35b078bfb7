// LZF, the light compression inside PCD files.
#pragma once

#include <span>
#include <string_view>

namespace sansmesh::inline v1::io {

/// Unpacks `packed` into exactly `out`; false if the data is damaged or does not fill it.
bool lzf_decompress(std::string_view packed, std::span<char> out);

}  // namespace sansmesh::inline v1::io
