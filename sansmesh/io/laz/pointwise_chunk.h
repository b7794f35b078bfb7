// Chunks of point formats 0 to 5: records are compressed point by point.
#pragma once

#include <string>

#include "sansmesh/io/laz/laz_layout.h"

namespace sansmesh::inline v1::io::laz {

/// Appends `count` records of `layout.record` bytes to `out`, compressed.
void encode_pointwise(const LazLayout& layout, const char* records, std::size_t count, std::string& out);

/// Decodes the chunk of `count` points at the beginning of `bytes`. Returns its length in bytes, or 0 if it is
/// damaged.
std::size_t decode_pointwise(const LazLayout& layout, std::string_view bytes, std::size_t count, char* records);

}  // namespace sansmesh::inline v1::io::laz
