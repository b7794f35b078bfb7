// Case-insensitive names.
#pragma once

#include <string>
#include <string_view>

namespace sansmesh::inline v1::io {

/// Lower-case copy (ASCII).
std::string lower(std::string_view s);

/// Ending of a file name in lower case without the dot and without a final ".gz": "a/B.PLY.gz" → "ply".
std::string ending(const std::string& file);

}  // namespace sansmesh::inline v1::io
