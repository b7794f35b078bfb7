// Endings of file names.
#pragma once

#include <string>

namespace sansmesh::inline v1::io {

/// Ending of a file name in lower case without the dot and without a final ".gz": "a/B.PLY.gz" → "ply".
std::string ending(const std::string& file);

}  // namespace sansmesh::inline v1::io
